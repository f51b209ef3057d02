#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso {

struct IndexOptions {
    int blockSize = 4;  ///< N: 2, 4, 8 or 16 cells a side
    Border border = Border::Closed;
};

/// The blocks that an isovalue touches, and what it cost to find them.
struct BlockQuery {
    std::vector<std::uint32_t> blocks;  ///< block numbers of the grid, ascending
    std::int64_t nodesVisited = 0;      ///< tree nodes looked at
};

/// A kd-tree over span space [Livnat1996; thesis 4.1]: built once per volume, it answers for any
/// isovalue which blocks hold a sample >= isovalue and a sample < isovalue.
///
/// Keeps (minimum, maximum) of every block in the volume's own pixel type; NaN counts as outside
/// (below every isovalue), and so do the virtual samples around the volume of a closed grid.
/// Cost: O(n log n) to build, O(sqrt(n) + k) to ask, n blocks, k of them in the answer. The same
/// volume gives the same tree, whatever the number of threads.
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
    PixelType pixelType() const;

    /// The blocks with minimum < isovalue <= maximum.
    BlockQuery blocksAt(double isovalue) const;

    /// Bytes that the tree holds.
    std::size_t memoryBytes() const;

private:
    class Impl;
    explicit SpanSpaceIndex(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace adaptiso
