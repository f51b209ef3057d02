#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "adaptiso/SurfaceProof/OrderedBuckets.h"

namespace adaptiso {
namespace {

using Buckets = detail::OrderedBuckets<std::uint32_t>;
using Lists = std::map<std::size_t, std::set<std::uint32_t>>;  ///< by bucket, none empty

Lists listsOf(const Buckets& buckets) {
    Lists lists;
    for (std::size_t b = 0; b < buckets.count(); ++b) {
        const auto items = buckets.of(b);
        EXPECT_TRUE(std::is_sorted(items.begin(), items.end()));
        if (!items.empty()) lists[b] = {items.begin(), items.end()};
    }
    return lists;
}

/// Item i goes into bucket i * i % count, and every third one into that of its double, too.
struct Givers {
    std::size_t count;
    template <class Put>
    void operator()(std::size_t i, const Put& put) const {
        put(i * i % count, static_cast<std::uint32_t>(i));
        if (i % 3 == 0 && 2 * i % count != i * i % count) {
            put(2 * i % count, static_cast<std::uint32_t>(i));
        }
    }
};

Lists expectedOf(std::size_t count, std::size_t givers) {
    Lists lists;
    for (std::uint32_t i = 0; i < givers; ++i) {
        Givers{count}(i,
                      [&](std::size_t bucket, std::uint32_t item) { lists[bucket].insert(item); });
    }
    return lists;
}

// 100,000 givers are taken by several threads, 1,000 by one.
TEST(OrderedBuckets, HoldWhatIsGivenInAscendingOrder) {
    Buckets buckets;
    for (const std::size_t givers : {0, 1, 1000, 100'000}) {
        for (const std::size_t count : {1, 17, 5000}) {
            buckets.assign(count, givers, Givers{count});
            EXPECT_EQ(buckets.count(), count);
            EXPECT_EQ(listsOf(buckets), expectedOf(count, givers));
        }
    }
}

TEST(OrderedBuckets, AreEmptyByDefault) {
    EXPECT_EQ(Buckets().count(), 0U);
}

// Random items go, others come, buckets come and go: as if all had been given anew.
TEST(OrderedBuckets, UpdateAsIfGivenAnew) {
    std::mt19937 random(1);
    for (int n = 0; n < 200; ++n) {
        const std::size_t before = 1 + random() % 40, after = 1 + random() % 40;
        Buckets buckets;
        buckets.assign(before, random() % 300, Givers{before});
        Lists expected = listsOf(buckets);
        const auto divisor = static_cast<std::uint32_t>(2 + random() % 5);
        const auto isGone = [&](std::uint32_t item) { return item % divisor == 0; };
        std::set<std::size_t> expectedChanged;
        for (auto& [bucket, items] : expected) {
            if (bucket < after && std::erase_if(items, isGone) > 0) expectedChanged.insert(bucket);
        }
        std::erase_if(expected,
                      [&](const auto& list) { return list.first >= after || list.second.empty(); });
        std::set<std::pair<std::size_t, std::uint32_t>> added;
        const auto many = static_cast<std::uint32_t>(random() % 30);
        for (std::uint32_t i = 0; i < many; ++i) {
            const auto& [bucket, item] = *added.insert({random() % after, 1000 + i}).first;
            expected[bucket].insert(item);
            expectedChanged.insert(bucket);
        }
        const std::vector<std::pair<std::size_t, std::uint32_t>> list(added.begin(), added.end());
        std::vector<std::size_t> changed;
        buckets.update(after, isGone, list, [&](std::size_t bucket) { changed.push_back(bucket); });
        EXPECT_EQ(buckets.count(), after);
        EXPECT_EQ(listsOf(buckets), expected);
        EXPECT_EQ(changed, std::vector(expectedChanged.begin(), expectedChanged.end()));
    }
}

}  // namespace
}  // namespace adaptiso
