#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "DicomHeader.h"

namespace adaptiso::detail {

/// The bytes of a DICOM file at any position, read through a window that moves along: a header is
/// thousands of small reads. For the deflated transfer syntax, the bytes that it inflates to.
class DicomBytes {
public:
    /// \throws FileError unless `file` is a readable regular file
    explicit DicomBytes(std::filesystem::path file);

    std::uint64_t size() const { return size_; }

    /// \throws FileError when they are not all there
    void read(std::uint64_t position, void* out, std::size_t byteCount);

    /// From now on position 0 is the first byte that the file inflates to from `from` on (RFC 1951,
    /// without zlib's frame; PS3.5, A.5). All of it is held in memory.
    /// \throws FileError when the data are damaged, or inflate to more than 512 MiB
    void inflateFrom(std::uint64_t from);

private:
    void moveWindow(std::uint64_t position);

    std::filesystem::path file_;
    std::ifstream stream_;
    std::uint64_t size_ = 0;
    std::string window_;
    std::uint64_t windowStart_ = 0;
};

/// Representation of a value in the file; unknown in some transfer syntaxes.
enum class DicomValueKind { Text, UInt16, UInt32, Float64, Digest };

/// The kind of a value that DicomDataset keeps; nothing for all others.
std::optional<DicomValueKind> wantedDicomValue(DicomTag tag);
bool isWantedDicomSequence(DicomTag tag);

/// A value's bytes as text: binary numbers as "1\\2.5".
std::string dicomText(std::string bytes, DicomValueKind kind, std::endian order);

}  // namespace adaptiso::detail
