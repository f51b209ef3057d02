#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace adaptiso::detail {

/// Compression of a chunk's bytes, from outside in.
/// Lz4Stream is N5's, of blocks as lz4-java writes them.
enum class ZarrCodec { Deflate, Zstd, Blosc, Lz4, Lz4Stream, Crc32c };

/// The codec of that name in version 2 ("zlib", "gzip", "zstd", "blosc", "lz4") or 3 of the format
/// ("gzip", "zstd", "blosc", "crc32c", and numcodecs' names). \throws FileError  any other
ZarrCodec zarrCodecOf(const std::filesystem::path& metadata, std::string_view name);

/// The bytes of a chunk, `byteCount` when unpacked.
/// \param codecs  in the order in which they packed it; none: it is as it lies
/// \param file    for messages
/// \throws FileError  the data are damaged, or unpack to more or fewer bytes
std::vector<std::byte> unpackZarrChunk(std::vector<std::byte> packed,
                                       std::span<const ZarrCodec> codecs, std::uint64_t byteCount,
                                       const std::filesystem::path& file);

/// The most that `byteCount` bytes may take when packed; more is a fault.
std::uint64_t zarrPackedLimit(std::uint64_t byteCount);

/// CRC-32C (Castagnoli), as iSCSI has it [RFC3720].
std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace adaptiso::detail
