#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace adaptiso {

/// Disjoint sets of the numbers 0 .. n - 1 (union-find, paths halved). A set is named by its
/// smallest member, so the order in which sets are joined does not show.
class DisjointSets {
public:
    explicit DisjointSets(std::int64_t n) : parent_(static_cast<std::size_t>(n)) {
        std::iota(parent_.begin(), parent_.end(), std::int64_t{0});
    }

    /// The smallest member of n's set.
    std::int64_t find(std::int64_t n) {
        while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
        return n;
    }

    void join(std::int64_t a, std::int64_t b) {
        const std::int64_t x = find(a), y = find(b);
        parent_[std::max(x, y)] = std::min(x, y);
    }

    /// find() of every number.
    std::vector<std::int64_t> names() && {
        for (std::int64_t& p : parent_) p = parent_[p];  // a parent is smaller: named by now
        return std::move(parent_);
    }

private:
    std::vector<std::int64_t> parent_;
};

}  // namespace adaptiso
