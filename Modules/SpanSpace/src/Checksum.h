#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace adaptiso::detail {

/// XXH64 of the bytes with seed 0 [Collet2012]: finds damage, keeps out no forger.
std::uint64_t xxh64(std::span<const std::byte> bytes);

/// Checksum of many bytes in parallel: XXH64 over the little-endian XXH64s of pieces of 1 MiB (the
/// last may be shorter), one piece at least. The same whatever the number of threads.
std::uint64_t checksumOf(std::span<const std::byte> bytes);

}  // namespace adaptiso::detail
