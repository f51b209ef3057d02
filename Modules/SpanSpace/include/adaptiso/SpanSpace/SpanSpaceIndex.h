#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso {

/// Methods to find the blocks of an isovalue. All give the same blocks in the same order.
enum class BlockSearchKind {
    KdTree,  ///< kd-tree over span space [Livnat1996; thesis 4.1]
    Octree,  ///< branch-on-need octree of minima and maxima [Wilhelms1992]
    Linear   ///< a look at every block
};

/// "kdtree", "octree", "linear"
std::string_view toString(BlockSearchKind kind);

struct IndexOptions {
    int blockSize = 4;  ///< N: 2, 4, 8 or 16 cells a side
    Border border = Border::Closed;
    BlockSearchKind search = BlockSearchKind::KdTree;
};

/// --block-size, --border and --search
const Options<IndexOptions>& indexOptions();

/// The blocks that an isovalue touches, and the cost of finding them.
struct BlockQuery {
    std::vector<std::uint32_t> blocks;  ///< block numbers of the grid, ascending
    std::int64_t nodesVisited = 0;      ///< nodes of the index whose range was looked at
};

/// An index over span space, (minimum, maximum) of every block: built once per volume, it answers
/// for any isovalue which blocks hold a sample >= isovalue and a sample < isovalue.
///
/// Keeps the ranges in the volume's own pixel type; NaN counts as outside (below every isovalue),
/// and so do the virtual samples around the volume of a closed grid.
/// Cost, n blocks, k of them in the answer: kd-tree O(n log n) to build, O(sqrt(n) + k) nodes to
/// ask; octree O(n) and O(k log n); linear O(n) and O(n). The same volume
/// gives the same index, whatever the number of threads.
class SpanSpaceIndex {
public:
    /// \throws InvalidInput when options.blockSize is not 2, 4, 8 or 16
    static SpanSpaceIndex build(const VolumeView& volume, const IndexOptions& options);

    SpanSpaceIndex(SpanSpaceIndex&&) noexcept;
    SpanSpaceIndex& operator=(SpanSpaceIndex&&) noexcept;
    SpanSpaceIndex(const SpanSpaceIndex&) = delete;  // large: move it
    SpanSpaceIndex& operator=(const SpanSpaceIndex&) = delete;
    ~SpanSpaceIndex();

    const BlockGrid& grid() const;
    BlockSearchKind search() const;
    IndexOptions options() const;  ///< those it was built with
    PixelType pixelType() const;

    /// The blocks with minimum < isovalue <= maximum.
    BlockQuery blocksAt(double isovalue) const;

    /// Bytes that the index holds: two samples for every node of the octree and every block of the
    /// linear scan; four samples and four bytes for every block of the kd-tree.
    std::size_t memoryBytes() const;

private:
    class Impl;
    explicit SpanSpaceIndex(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The blocks that one isovalue touches, found by a look at every sample: those that an index of
/// the volume gives, in the same order, without the memory of one. For one isovalue of a volume.
/// \pre grid is of the volume's size
BlockQuery findBlocksAt(const VolumeView& volume, const BlockGrid& grid, double isovalue);

}  // namespace adaptiso
