#include "MinMaxOctree.h"

#include <algorithm>
#include <utility>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

template <class T>
MinMaxOctree<T>::MinMaxOctree(BlockRanges<T> ranges, const BlockGrid& grid) {
    levels_.push_back({grid.blocks, std::move(ranges)});
    while (levels_.back().ranges.minimum.size() > 1) levels_.push_back(above(levels_.back()));
}

template <class T>
typename MinMaxOctree<T>::Level MinMaxOctree<T>::above(const Level& below) {
    Level level;
    for (int axis = 0; axis < 3; ++axis) level.size[axis] = (below.size[axis] + 1) / 2;
    const auto& [nx, ny, nz] = level.size;
    level.ranges.minimum.resize(nx * ny * nz);
    level.ranges.maximum.resize(nx * ny * nz);
    const auto& [bx, by, bz] = below.size;

    parallelForPieces(ny * nz, 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t row = begin; row < end; ++row) {
            const std::int64_t y = row % ny, z = row / ny;
            for (std::int64_t x = 0; x < nx; ++x) {
                const std::int64_t first = 2 * x + bx * (2 * y + by * 2 * z);
                T low = below.ranges.minimum[first], high = below.ranges.maximum[first];
                for (std::int64_t k = 2 * z; k < std::min(2 * z + 2, bz); ++k) {
                    for (std::int64_t j = 2 * y; j < std::min(2 * y + 2, by); ++j) {
                        for (std::int64_t i = 2 * x; i < std::min(2 * x + 2, bx); ++i) {
                            low = std::min(low, below.ranges.minimum[i + bx * (j + by * k)]);
                            high = std::max(high, below.ranges.maximum[i + bx * (j + by * k)]);
                        }
                    }
                }
                level.ranges.minimum[x + nx * row] = low;
                level.ranges.maximum[x + nx * row] = high;
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

    void visit(std::size_t depth, std::int64_t x, std::int64_t y, std::int64_t z) {
        const Level& level = levels[depth];
        const std::int64_t node = x + level.size[0] * (y + level.size[1] * z);
        ++visited;
        if (level.ranges.minimum[node] >= threshold || level.ranges.maximum[node] < threshold) {
            return;
        }
        if (depth == 0) {
            found.push_back(static_cast<std::uint32_t>(node));
            return;
        }
        const Index3& children = levels[depth - 1].size;
        for (std::int64_t k = 2 * z; k < std::min(2 * z + 2, children[2]); ++k) {
            for (std::int64_t j = 2 * y; j < std::min(2 * y + 2, children[1]); ++j) {
                for (std::int64_t i = 2 * x; i < std::min(2 * x + 2, children[0]); ++i) {
                    visit(depth - 1, i, j, k);
                }
            }
        }
    }
};

template <class T>
std::int64_t MinMaxOctree<T>::search(T threshold, std::vector<std::uint32_t>& found) const {
    Walk walk{levels_, threshold, found};
    walk.visit(levels_.size() - 1, 0, 0, 0);
    sortBlocks(found, std::ssize(levels_.front().ranges.minimum));
    return walk.visited;
}

template <class T>
std::size_t MinMaxOctree<T>::memoryBytes() const {
    std::size_t nodes = 0;
    for (const Level& level : levels_) nodes += level.ranges.minimum.size();
    return nodes * 2 * sizeof(T);
}

template <class T>
std::vector<std::span<const std::byte>> MinMaxOctree<T>::arrays() const {
    const BlockRanges<T>& blocks = levels_.front().ranges;
    return {std::as_bytes(std::span(blocks.minimum)), std::as_bytes(std::span(blocks.maximum))};
}

template class MinMaxOctree<std::uint8_t>;
template class MinMaxOctree<std::int8_t>;
template class MinMaxOctree<std::uint16_t>;
template class MinMaxOctree<std::int16_t>;
template class MinMaxOctree<std::uint32_t>;
template class MinMaxOctree<std::int32_t>;
template class MinMaxOctree<std::uint64_t>;
template class MinMaxOctree<std::int64_t>;
template class MinMaxOctree<float>;
template class MinMaxOctree<double>;

}  // namespace adaptiso::detail
