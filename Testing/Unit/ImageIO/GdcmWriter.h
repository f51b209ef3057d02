#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::testing {

enum class DicomCodec {
    ImplicitLittleEndian,
    ExplicitLittleEndian,
    Rle,
    JpegLossless,
    JpegLsLossless,
    Jpeg2000Lossless
};

/// One frame's codestream as GDCM compresses it.
/// \param samples  rows * columns words of `bits` (of 16), all of them a codec's own width
std::string encodeWithGdcm(const std::vector<std::uint16_t>& samples, int columns, int rows,
                           int bits, bool isSigned, DicomCodec codec);

/// The transfer syntax UID.
const char* uidOf(DicomCodec codec);

/// A square CT slice of size * size uint16 samples, 0.5 mm pixels, written by GDCM.
void writeWithGdcm(const std::filesystem::path& file, const std::vector<std::uint16_t>& samples,
                   int size, const Vec3& position, const Vec3& alongRow, const Vec3& alongColumn,
                   DicomCodec codec);

}  // namespace adaptiso::testing
