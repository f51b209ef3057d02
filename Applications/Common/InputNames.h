#pragma once

#include <filesystem>
#include <string>

namespace adaptiso {

/// The input's name without folder and without the extensions of image files: "brain" of
/// "scans/brain.nii.gz"; the folder's own name of a folder, however it is written, without
/// ".zarr" or ".ome.zarr".
std::string inputStem(const std::filesystem::path& input);

}  // namespace adaptiso
