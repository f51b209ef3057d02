#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

namespace adaptiso::detail {

/// `byteCount` bytes of an open file from `offset` on, mapped for reading, where that is safe:
///   - the file lies on a local disk, not on one that a network or another process can take away;
///   - it is this user's, and a read lease (fcntl, F_SETLEASE) holds back whoever would write or
///     shorten it, as long as the system allows (/proc/sys/fs/lease-break-time, 45 s);
///   - it is large enough to be worth it (kLeastMappedBytes).
/// Elsewhere nothing is returned, and the caller reads. The mapping keeps the lease.
std::shared_ptr<const void> mapFile(const std::filesystem::path& file, int descriptor,
                                    std::uint64_t offset, std::uint64_t byteCount);

inline constexpr std::uint64_t kLeastMappedBytes = std::uint64_t{16} << 20;

}  // namespace adaptiso::detail
