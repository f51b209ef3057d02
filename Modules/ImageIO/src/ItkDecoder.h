#pragma once

#include <filesystem>

#include "Samples.h"

namespace adaptiso::detail {

/// Has ITK decode the samples of a NRRD file whose header and length have been checked here. Only
/// the samples are taken from ITK, never the geometry. For behind the fence.
///
/// \throws FileError when ITK can't decode it or understands the header otherwise than we do
Volume decodeNrrdWithItk(const std::filesystem::path& file, PixelType type,
                         const ImageGeometry& geometry);

}  // namespace adaptiso::detail
