#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "BlockRanges.h"

namespace adaptiso::detail {

/// The kd-tree over span space [Livnat1996, section 4]: a median tree without pointers. The root
/// of a range is its middle element; levels split on the minimum and on the maximum in turn, ties
/// broken by block number. Holds three arrays in tree order.
template <class T>
class SpanTree {
public:
    explicit SpanTree(BlockRanges<T> ranges);

    /// Appends to `found` the blocks with minimum < threshold <= maximum, in tree order.
    /// \return nodes looked at
    std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const;

    std::int64_t size() const { return static_cast<std::int64_t>(block_.size()); }
    std::size_t memoryBytes() const { return block_.size() * (2 * sizeof(T) + sizeof(block_[0])); }

private:
    struct Walk;
    std::vector<T> minimum_;
    std::vector<T> maximum_;
    std::vector<std::uint32_t> block_;
};

}  // namespace adaptiso::detail
