#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "adaptiso/Core/Memory.h"

namespace adaptiso {

/// Items in numbered buckets, sorted by counting: those of a bucket lie side by side, in the order
/// in which they were given. \tparam Place  an unsigned or signed integer that can count the items
template <class Item, class Place = std::size_t>
class Buckets {
public:
    Buckets() = default;

    /// \param giveAll  called twice with a function (bucket, item), which it calls for every item;
    ///                 gives the same in both
    template <class GiveAll>
    Buckets(std::size_t count, const GiveAll& giveAll) {
        assign(count, giveAll);
    }

    /// Like the constructor, within the memory already held.
    template <class GiveAll>
    void assign(std::size_t count, const GiveAll& giveAll) {
        assignInHugePages(begin_, count + 2);
        giveAll([&](std::size_t bucket, const Item&) { ++begin_[bucket + 2]; });
        for (std::size_t b = 2; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
        assignInHugePages(items_, static_cast<std::size_t>(begin_.back()));
        // begin_[bucket + 1] grows to the bucket's end
        giveAll([&](std::size_t bucket, const Item& item) { items_[begin_[bucket + 1]++] = item; });
    }

    std::span<const Item> of(std::size_t bucket) const { return of(bucket, bucket + 1); }
    std::span<Item> of(std::size_t bucket) {
        return {items_.data() + begin_[bucket], items_.data() + begin_[bucket + 1]};
    }
    /// Items of the buckets from `first` up to `end`, which lie side by side.
    std::span<const Item> of(std::size_t first, std::size_t end) const {
        return {items_.data() + begin_[first], items_.data() + begin_[end]};
    }

    /// Buckets.
    std::size_t count() const { return begin_.size() - 2; }
    std::size_t itemCount() const { return items_.size(); }

private:
    std::vector<Place> begin_{0, 0};
    std::vector<Item> items_;
};

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
