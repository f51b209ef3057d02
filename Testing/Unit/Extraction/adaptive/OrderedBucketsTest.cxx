#include <gtest/gtest.h>

#include <map>
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

}  // namespace
}  // namespace adaptiso
