#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ByteSource.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Samples that stand in a file as decimal numbers, apart by blanks or commas.
///
/// Whole numbers may be written as 12, 12.0 or 1.2e1; of floating-point types NaN and infinities
/// are numbers too. A few numbers too many are left out with a warning.
/// \throws FileError  numbers are missing, one is no number or none of this type (300 for 8 bits,
///         1.5 for integers, 1e99 for float), or as many more follow as more slices would have
Volume readNrrdText(const std::filesystem::path& file, ByteSource& source, PixelType type,
                    const ImageGeometry& geometry, std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
