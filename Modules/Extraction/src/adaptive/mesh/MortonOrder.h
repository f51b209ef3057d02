#pragma once

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "Certificate.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

/// The numbers below `count` in the order of their points along a curve through 1,024 cubes a side,
/// halved axis by axis [Morton1966]: what is near in the list is near in space. Those of one cube
/// come in ascending order.
/// \param box      of the points
/// \param pointOf  of a number
template <class PointOf>
std::vector<std::uint32_t> inMortonOrder(std::size_t count, const CornerBox& box,
                                         const PointOf& pointOf) {
    constexpr int kBits = 10;
    constexpr std::int64_t kPiece = 1 << 13;
    constexpr double kLast = (1 << kBits) - 1;
    const Vec3 extent = box.high - box.low;
    const double widest = std::max({extent.x, extent.y, extent.z}),
                 unit = widest > 0 ? kLast / widest : 0;
    std::array<std::uint64_t, std::size_t{1} << kBits> spread{};  // bits abc to a00b00c
    for (std::size_t i = 0; i < spread.size(); ++i) {
        for (int bit = 0; bit < kBits; ++bit) spread[i] |= (i >> bit & 1) << (3 * bit);
    }
    const auto along = [&](double place) {
        // not a number where coordinates are too large for their difference
        return spread[place > 0 ? static_cast<std::size_t>(std::min(place, kLast)) : 0];
    };
    std::vector<std::uint64_t> keys(count);
    std::vector<std::uint32_t> order(count);
    const auto forEach = [&](const auto& f) {
        parallelForPieces(static_cast<std::int64_t>(count), kPiece,
                          [&](std::int64_t begin, std::int64_t end) {
                              for (std::int64_t i = begin; i < end; ++i) f(i);
                          });
    };
    forEach([&](std::int64_t i) {
        const Vec3 p = unit * (pointOf(static_cast<std::uint32_t>(i)) - box.low);
        const std::uint64_t key = along(p.x) << 2 | along(p.y) << 1 | along(p.z);
        keys[i] = key << 32 | static_cast<std::uint64_t>(i);
    });
    tbb::parallel_sort(keys.begin(), keys.end());
    forEach([&](std::int64_t i) { order[i] = static_cast<std::uint32_t>(keys[i]); });
    return order;
}

}  // namespace adaptiso::detail
