#pragma once

#include <cstdint>
#include <vector>

#include "BlockRanges.h"
#include "BlockSearch.h"

namespace adaptiso::detail {

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

}  // namespace adaptiso::detail
