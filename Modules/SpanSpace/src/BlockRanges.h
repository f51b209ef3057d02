#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

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

}  // namespace adaptiso::detail
