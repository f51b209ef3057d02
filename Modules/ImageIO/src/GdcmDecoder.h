#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace adaptiso::detail {

/// Description of a codestream from its own header.
struct Codestream {
    std::int64_t columns = 0, rows = 0;
    int components = 0, precision = 0;
    bool isSigned = false;

    std::size_t wordBytes() const { return precision <= 8 ? 1 : 2; }
};

/// Has GDCM decode one frame's JPEG, JPEG-LS or JPEG 2000 codestream. GDCM sees the codestream
/// alone, no DICOM header.
///
/// \param samples  columns * rows words of wordBytes(), this machine's byte order
/// \throws FileError when GDCM can't
void decodeWithGdcm(const std::filesystem::path& file, std::string_view stream,
                    const std::string& transferSyntax, const Codestream& codestream,
                    std::span<std::byte> samples);

}  // namespace adaptiso::detail
