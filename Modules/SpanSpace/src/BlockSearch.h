#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

/// Calls a macro with every type of sample: for explicit instantiations.
#define ADAPTISO_FOR_EACH_SAMPLE_TYPE(macro)                                              \
    macro(std::uint8_t) macro(std::int8_t) macro(std::uint16_t) macro(std::int16_t)       \
        macro(std::uint32_t) macro(std::int32_t) macro(std::uint64_t) macro(std::int64_t) \
            macro(float) macro(double)

namespace adaptiso::detail {

/// Smallest and largest sample of every block, in the volume's own type, indexed by block number.
/// A block that holds virtual outside samples or NaN has the type's lowest value as its minimum
/// (for floats -infinity): they are outside for every isovalue.
template <class T>
struct BlockRanges {
    std::vector<T> minimum;
    std::vector<T> maximum;
};

template <class T>
BlockRanges<T> computeBlockRanges(const TypedVolumeView<T>& volume, const BlockGrid& grid);

/// The blocks with minimum < threshold <= maximum, ascending, without keeping any range.
template <class T>
std::vector<std::uint32_t> blocksAround(const TypedVolumeView<T>& volume, const BlockGrid& grid,
                                        T threshold);

/// Finds the blocks that a threshold touches: one contract, so that the ways to search can
/// stand in for each other and be compared.
template <class T>
class BlockSearch {
public:
    virtual ~BlockSearch() = default;

    /// Puts the blocks with minimum < threshold <= maximum into `found`, ascending.
    /// \pre `found` is empty   \return nodes looked at
    virtual std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const = 0;

    /// Bytes held beside the object itself.
    virtual std::size_t memoryBytes() const = 0;
};

/// Sorts distinct block numbers < blockCount, in O(blocks.size() + blockCount / 64) where there are
/// many: through a bit a block.
void sortBlocks(std::vector<std::uint32_t>& blocks, std::int64_t blockCount);

/// Looks at the range of every block: what the trees are measured by.
template <class T>
class LinearScan final : public BlockSearch<T> {
public:
    explicit LinearScan(BlockRanges<T> ranges) : ranges_(std::move(ranges)) {}

    std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const override {
        const std::int64_t count = std::ssize(ranges_.minimum);
        for (std::int64_t b = 0; b < count; ++b) {
            if (ranges_.minimum[b] < threshold && ranges_.maximum[b] >= threshold) {
                found.push_back(static_cast<std::uint32_t>(b));
            }
        }
        return count;
    }
    std::size_t memoryBytes() const override { return ranges_.minimum.size() * 2 * sizeof(T); }

private:
    BlockRanges<T> ranges_;
};

/// The kd-tree over span space [Livnat1996, section 4]: a median tree without pointers. The root
/// of a range is its middle element; levels split on the minimum and on the maximum in turn, ties
/// broken by the other of the two, then by block number. Holds three arrays in tree order.
///
/// Departure: two more, that follow from those, hold the least minimum and the greatest maximum of
/// every subtree. A walk turns back where they say that nothing is to be found; splitting values
/// alone tell it only that a subtree lies beside the threshold's lines, not that it is empty there.
template <class T>
class SpanTree final : public BlockSearch<T> {
public:
    explicit SpanTree(BlockRanges<T> ranges);

    std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const override;

    std::int64_t size() const { return static_cast<std::int64_t>(block_.size()); }
    std::size_t memoryBytes() const override {
        return block_.size() * (4 * sizeof(T) + sizeof(block_[0]));
    }

private:
    struct Walk;
    void findExtremes(std::int64_t begin, std::int64_t end);

    std::vector<T> minimum_;
    std::vector<T> maximum_;
    std::vector<std::uint32_t> block_;
    std::vector<T> leastMinimum_;  ///< of the node and all below
    std::vector<T> greatestMaximum_;
};

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
