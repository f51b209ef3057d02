#pragma once

#include <utility>

#include "BlockRanges.h"
#include "BlockSearch.h"

namespace adaptiso::detail {

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

}  // namespace adaptiso::detail
