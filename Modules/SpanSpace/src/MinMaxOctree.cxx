#include <algorithm>
#include <utility>

#include "BlockSearch.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

std::int64_t numberOf(const Index3& size, const Index3& node) {
    return node[0] + size[0] * (node[1] + size[1] * node[2]);
}

/// Calls f(child) for the nodes of a level of `size` that lie below `node` of the next.
template <class F>
void forEachChild(const Index3& size, const Index3& node, const F& f) {
    for (std::int64_t k = 2 * node[2]; k < std::min(2 * node[2] + 2, size[2]); ++k) {
        for (std::int64_t j = 2 * node[1]; j < std::min(2 * node[1] + 2, size[1]); ++j) {
            for (std::int64_t i = 2 * node[0]; i < std::min(2 * node[0] + 2, size[0]); ++i) {
                f(Index3{i, j, k});
            }
        }
    }
}

}  // namespace

template <class T>
MinMaxOctree<T>::MinMaxOctree(BlockRanges<T> ranges, const BlockGrid& grid) {
    levels_.push_back({grid.blocks, std::move(ranges)});
    while (levels_.back().ranges.minimum.size() > 1) levels_.push_back(above(levels_.back()));
}

template <class T>
typename MinMaxOctree<T>::Level MinMaxOctree<T>::above(const Level& below) {
    Level level;
    for (int axis = 0; axis < 3; ++axis) level.size[axis] = (below.size[axis] + 1) / 2;
    const Index3& n = level.size;
    const std::vector<T>&minimum = below.ranges.minimum, &maximum = below.ranges.maximum;
    level.ranges.minimum.resize(n[0] * n[1] * n[2]);
    level.ranges.maximum.resize(n[0] * n[1] * n[2]);

    parallelForPieces(n[1] * n[2], 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t row = begin; row < end; ++row) {
            for (std::int64_t x = 0; x < n[0]; ++x) {
                const Index3 node{x, row % n[1], row / n[1]};
                const std::int64_t first = numberOf(below.size, {2 * x, 2 * node[1], 2 * node[2]});
                T low = minimum[first], high = maximum[first];
                forEachChild(below.size, node, [&](const Index3& child) {
                    low = std::min(low, minimum[numberOf(below.size, child)]);
                    high = std::max(high, maximum[numberOf(below.size, child)]);
                });
                level.ranges.minimum[x + n[0] * row] = low;
                level.ranges.maximum[x + n[0] * row] = high;
            }
        }
    });
    return level;
}

template <class T>
struct MinMaxOctree<T>::Walk {
    const std::vector<Level>& levels;
    const T threshold;
    std::vector<std::uint32_t>& found;
    std::int64_t visited = 0;

    void visit(std::size_t depth, const Index3& node) {
        const Level& level = levels[depth];
        const std::int64_t number = numberOf(level.size, node);
        ++visited;
        if (level.ranges.minimum[number] >= threshold || level.ranges.maximum[number] < threshold) {
            return;
        }
        if (depth == 0) {
            found.push_back(static_cast<std::uint32_t>(number));
            return;
        }
        forEachChild(levels[depth - 1].size, node,
                     [&](const Index3& child) { visit(depth - 1, child); });
    }
};

template <class T>
std::int64_t MinMaxOctree<T>::search(T threshold, std::vector<std::uint32_t>& found) const {
    Walk walk{levels_, threshold, found};
    walk.visit(levels_.size() - 1, {0, 0, 0});
    sortBlocks(found, std::ssize(levels_.front().ranges.minimum));
    return walk.visited;
}

template <class T>
std::size_t MinMaxOctree<T>::memoryBytes() const {
    std::size_t nodes = 0;
    for (const Level& level : levels_) nodes += level.ranges.minimum.size();
    return nodes * 2 * sizeof(T);
}

#define ADAPTISO_INSTANTIATE(T) template class MinMaxOctree<T>;
ADAPTISO_FOR_EACH_SAMPLE_TYPE(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
