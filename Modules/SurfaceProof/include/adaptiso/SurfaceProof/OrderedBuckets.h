#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

/// Items in numbered buckets, as Core's Buckets, filled by several threads where there are many.
/// Those of a bucket lie side by side in ascending order, whatever the number of threads.
template <class Item, class Place = std::uint32_t>
class OrderedBuckets {
public:
    /// Uses the memory that is there.
    /// \param give  give(i, put) calls put(bucket, item) for the items of the numbers i in
    ///              [0, givers), in ascending order in each bucket
    template <class Give>
    void assign(std::size_t count, std::size_t givers, const Give& give) {
        constexpr std::size_t kMany = 1 << 15;  // below, threads cost more than they save
        assignInHugePages(begin_, count + 2);
        if (givers < kMany) {
            assignInOrder(givers, give);
        } else {
            assignSideBySide(givers, give);
        }
    }

    std::size_t count() const { return begin_.size() - 2; }
    std::span<const Item> of(std::size_t bucket) const {
        return {items_.data() + begin_[bucket], items_.data() + begin_[bucket + 1]};
    }

private:
    void sumUp() {
        for (std::size_t b = 2; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
        assignInHugePages(items_, static_cast<std::size_t>(begin_.back()));
    }

    template <class Give>
    void assignInOrder(std::size_t givers, const Give& give) {
        for (std::size_t i = 0; i < givers; ++i) {
            give(i, [&](std::size_t bucket, const Item&) { ++begin_[bucket + 2]; });
        }
        sumUp();
        // begin_[bucket + 1] grows to the bucket's end
        for (std::size_t i = 0; i < givers; ++i) {
            give(i, [&](std::size_t bucket, const Item& item) {
                items_[begin_[bucket + 1]++] = item;
            });
        }
    }

    /// As threads come, and each bucket sorted then.
    template <class Give>
    void assignSideBySide(std::size_t givers, const Give& give) {
        constexpr std::int64_t kPiece = 1 << 14;
        const auto forAll = [&](std::size_t count, const auto& f) {
            parallelForPieces(static_cast<std::int64_t>(count), kPiece,
                              [&](std::int64_t begin, std::int64_t end) {
                                  for (std::int64_t i = begin; i < end; ++i) f(i);
                              });
        };
        const auto grow = [&](std::size_t at) {
            return std::atomic_ref(begin_[at]).fetch_add(1, std::memory_order_relaxed);
        };
        forAll(givers, [&](std::size_t i) {
            give(i, [&](std::size_t bucket, const Item&) { grow(bucket + 2); });
        });
        sumUp();
        forAll(givers, [&](std::size_t i) {
            give(i, [&](std::size_t bucket, const Item& item) { items_[grow(bucket + 1)] = item; });
        });
        forAll(begin_.size() - 2, [&](std::size_t bucket) {
            std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin_[bucket]),
                      items_.begin() + static_cast<std::ptrdiff_t>(begin_[bucket + 1]));
        });
    }

    std::vector<Place> begin_{0, 0};
    std::vector<Item> items_;
};

}  // namespace adaptiso::detail
