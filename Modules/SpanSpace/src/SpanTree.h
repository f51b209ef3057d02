#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "BlockRanges.h"
#include "BlockSearch.h"

namespace adaptiso::detail {

/// The kd-tree over span space [Livnat1996, section 4]: a median tree without pointers. The root
/// of a range is its middle element; levels split on the minimum and on the maximum in turn, ties
/// broken by block number. Holds three arrays in tree order.
template <class T>
class SpanTree final : public BlockSearch<T> {
public:
    explicit SpanTree(BlockRanges<T> ranges);

    /// The tree of nodes that come from outside, in tree order; null unless it is the very tree
    /// that the constructor makes of `ranges`. \pre as many of each as `ranges` has
    static std::unique_ptr<SpanTree> restored(BlockRanges<T> nodes,
                                              std::vector<std::uint32_t> block,
                                              const BlockRanges<T>& ranges);

    std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const override;

    std::int64_t size() const { return static_cast<std::int64_t>(block_.size()); }
    std::size_t memoryBytes() const override {
        return block_.size() * (2 * sizeof(T) + sizeof(block_[0]));
    }
    std::vector<std::span<const std::byte>> arrays() const override {
        return {std::as_bytes(std::span(minimum_)), std::as_bytes(std::span(maximum_)),
                std::as_bytes(std::span(block_))};
    }

private:
    struct Walk;
    struct Order;
    SpanTree() = default;
    bool holds(const BlockRanges<T>& ranges) const;

    std::vector<T> minimum_;
    std::vector<T> maximum_;
    std::vector<std::uint32_t> block_;
};

}  // namespace adaptiso::detail
