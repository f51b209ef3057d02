#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace adaptiso {

// What a file holds behind the data that it counts. One rule for images and meshes:
//   zeros, no more than kMostPadding  padding: a warning
//   isMoreData()                      more of the same than was counted: refused; of images also
//                                     a row or column of every slice (isMoreImage())
//   anything else                     a warning

inline constexpr std::size_t kMostPadding = std::size_t{1} << 16;

bool areZeros(std::string_view bytes);

/// True if `surplus` bytes are whole records (slices, triangles), or half as much as was counted
/// and more. \param record, counted  bytes of one record, and of all that were counted
bool isMoreData(std::uint64_t surplus, std::uint64_t record, std::uint64_t counted);

/// What a file may unpack to, all its parts together: any size up to `freeBytes`, beyond that
/// `times` the bytes that are stored.
struct UnpackLimit {
    std::uint64_t freeBytes = 0, times = 1;

    bool allows(std::uint64_t storedBytes, std::uint64_t bytes) const {
        return bytes <= freeBytes || bytes / times <= storedBytes;
    }
};

/// A mask with one voxel in a million set stays below it.
inline constexpr UnpackLimit kImageUnpackLimit{std::uint64_t{1} << 30, 1000};
inline constexpr UnpackLimit kSurfaceUnpackLimit{std::uint64_t{1} << 26, 100};

}  // namespace adaptiso
