#pragma once

#include <filesystem>

#include "Samples.h"

namespace adaptiso::detail {

enum class ItkFormat { Nrrd, MetaImage };

/// Has ITK decode the samples of a file whose header and length have been checked here. Only the
/// samples are taken from ITK, never the geometry.
///
/// \throws FileError when ITK can't decode it or understands the header otherwise than we do
Volume decodeWithItk(ItkFormat format, const std::filesystem::path& file, PixelType type,
                     const ImageGeometry& geometry);

}  // namespace adaptiso::detail
