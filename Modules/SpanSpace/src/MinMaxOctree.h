#pragma once

#include <vector>

#include "BlockRanges.h"
#include "BlockSearch.h"

namespace adaptiso::detail {

/// The octree of minima and maxima over the blocks [Wilhelms1992], branch-on-need: node (x, y, z)
/// of a level covers nodes (2x .. 2x + 1, 2y .. 2y + 1, 2z .. 2z + 1) of the level below, as far as
/// there are any, so that a grid that is no power of two costs no empty nodes. Without pointers: a
/// level is an array of its own, halved and rounded up along each axis from the one below.
///
/// Departure: the leaves are the blocks, not cells two by two by two.
template <class T>
class MinMaxOctree final : public BlockSearch<T> {
public:
    MinMaxOctree(BlockRanges<T> ranges, const BlockGrid& grid);

    std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const override;
    std::size_t memoryBytes() const override;

private:
    struct Level {
        Index3 size;
        BlockRanges<T> ranges;
    };
    struct Walk;
    static Level above(const Level& below);

    std::vector<Level> levels_;  ///< the blocks first, the root last
};

}  // namespace adaptiso::detail
