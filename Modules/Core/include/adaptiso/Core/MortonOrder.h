#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

namespace detail {

/// A curve through 1,024 cubes a side of a box, halved axis by axis [Morton1966].
class MortonCurve {
public:
    explicit MortonCurve(const BoundingBox& box);

    /// Key of the cube that a point lies in: 30 bits.
    std::uint64_t placeOf(const Vec3& point) const {
        const Vec3 p = unit_ * (point - low_);
        return along(p.x) << 2 | along(p.y) << 1 | along(p.z);
    }

private:
    static constexpr int kBits = 10;
    static constexpr double kLast = (1 << kBits) - 1;

    std::uint64_t along(double place) const {
        // not a number where coordinates are too large for their difference
        return spread_[place > 0 ? static_cast<std::size_t>(place < kLast ? place : kLast) : 0];
    }

    Vec3 low_;
    double unit_;
    std::array<std::uint64_t, std::size_t{1} << kBits> spread_{};  ///< bits abc to a00b00c
};

/// The lower halves of the keys, sorted by the keys.
std::vector<std::uint32_t> sortedByKeys(std::vector<std::uint64_t> keys);

}  // namespace detail

/// The numbers below `count` in the order of their points along a Morton curve: what is near in the
/// list is near in space. Those of one of its cubes come in ascending order.
/// \param box      of the points
/// \param pointOf  of a number
/// \pre count < 2^32
template <class PointOf>
std::vector<std::uint32_t> inMortonOrder(std::size_t count, const BoundingBox& box,
                                         const PointOf& pointOf) {
    constexpr std::int64_t kPiece = 1 << 13;
    const detail::MortonCurve curve(box);
    std::vector<std::uint64_t> keys;
    assignInHugePages(keys, count);
    parallelForPieces(static_cast<std::int64_t>(count), kPiece,
                      [&](std::int64_t begin, std::int64_t end) {
                          for (std::int64_t i = begin; i < end; ++i) {
                              keys[static_cast<std::size_t>(i)] =
                                  curve.placeOf(pointOf(static_cast<std::uint32_t>(i))) << 32 |
                                  static_cast<std::uint64_t>(i);
                          }
                      });
    return detail::sortedByKeys(std::move(keys));
}

/// A node of a binary tree over a list of leaves, and the leaves below it. Every node halves its
/// leaves, down to single ones, and the nodes lie in one array in depth-first order: so where
/// children lie follows from counts alone.
struct HalvedLeaves {
    std::int64_t node, firstLeaf, leaves;

    bool isLeaf() const { return leaves == 1; }
    HalvedLeaves left() const { return {node + 1, firstLeaf, leaves / 2}; }
    HalvedLeaves right() const {
        return {node + 2 * (leaves / 2), firstLeaf + leaves / 2, leaves - leaves / 2};
    }

    /// Nodes left to visit: halving leaves no more than 64 levels, with one node a level left to
    /// do.
    using Stack = std::array<HalvedLeaves, 64>;
};

}  // namespace adaptiso
