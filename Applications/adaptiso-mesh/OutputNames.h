#pragma once

#include <filesystem>
#include <string>

#include "Pipeline.h"

namespace adaptiso {

/// The input's name without folder and without the extensions of image files: "brain" of
/// "scans/brain.nii.gz"; the folder's own name of a folder, however it is written.
std::string inputStem(const std::filesystem::path& input);

/// The file that the surface at an isovalue goes to.
///
/// Without an output in `options`: "<stem>-iso<isovalue>.vtp" in the current folder. An output
/// with "{iso}" in its name has the isovalue in that place. Otherwise the output is taken as it
/// is for one isovalue, and for several gets "-iso<isovalue>" before its extension.
/// \param isovalue  as text: formatNumber(), or "auto" while it is not known yet
std::filesystem::path outputPath(const MeshOptions& options, const std::string& isovalue);

}  // namespace adaptiso
