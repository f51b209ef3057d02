#pragma once

#include <filesystem>
#include <string>

#include "Pipeline.h"

namespace adaptiso {

/// The file that the surface at an isovalue goes to.
///
/// Without an output in `options`: "<stem>-iso<isovalue>.vtp" in the current folder. An output
/// with "{iso}" in its name has the isovalue in that place. Otherwise the output is taken as it
/// is for one isovalue, and for several gets "-iso<isovalue>" before its extension.
/// \param isovalue  as text: formatNumber(), or "auto" while it is not known yet
std::filesystem::path outputPath(const MeshOptions& options, const std::string& isovalue);

}  // namespace adaptiso
