#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "DicomFile.h"

namespace adaptiso::detail {

enum class DicomCodec { None, Rle, Jpeg, Jpeg2000 };  ///< Jpeg: JPEG-LS too

/// True if these first bytes of a fragment begin a frame; unknown for RLE.
bool beginsDicomCodestream(std::string_view head, DicomCodec codec);

/// One frame of run-length coded bytes (PS3.5, annex G) to `format`'s samples.
/// \throws FileError when they are damaged
void decodeDicomRle(const std::filesystem::path& file, std::string_view stream,
                    const DicomPixelFormat& format, std::vector<std::byte>& samples);

/// One frame's JPEG, JPEG-LS or JPEG 2000 codestream to `format`'s samples, by GDCM, once the
/// codestream's own header has been found to agree with `format`.
/// \throws FileError when it does not, or when the codestream is damaged
void decodeDicomJpeg(const std::filesystem::path& file, std::string stream, DicomCodec codec,
                     const std::string& transferSyntax, const DicomPixelFormat& format,
                     std::vector<std::byte>& samples);

}  // namespace adaptiso::detail
