#pragma once

#include <cstdint>
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
    std::vector<T> minimum_;
    std::vector<T> maximum_;
    std::vector<std::uint32_t> block_;
};

}  // namespace adaptiso::detail
