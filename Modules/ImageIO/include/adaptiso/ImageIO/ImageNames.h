#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace adaptiso {

/// The extension that names a file as an image, of any case: ".nii.gz"; empty for other names.
std::string_view imageExtension(const std::filesystem::path& file);

/// The input's name without folder and without the extensions of image files: "brain" of
/// "scans/brain.nii.gz"; the folder's own name of a folder, however it is written, without
/// ".zarr" or ".ome.zarr".
std::string inputStem(const std::filesystem::path& input);

}  // namespace adaptiso
