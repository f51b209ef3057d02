#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "adaptiso/Core/Buckets.h"

namespace adaptiso::testing {

TEST(Buckets, HoldsNothingBeforeItIsAssigned) {
    const Buckets<int> none;
    EXPECT_EQ(none.count(), 0U);
    EXPECT_EQ(none.itemCount(), 0U);
}

TEST(Buckets, KeepsTheOrderInWhichItemsAreGiven) {
    std::mt19937 random(1);
    Buckets<int, std::uint32_t> buckets;
    for (const int count : {1, 7, 100, 3}) {  // the memory of the one before is used again
        std::vector<std::pair<std::size_t, int>> given;
        for (int i = 0; i < 5 * count; ++i) given.emplace_back(random() % count, i);
        std::map<std::size_t, std::vector<int>> expected;
        for (const auto& [bucket, item] : given) expected[bucket].push_back(item);
        buckets.assign(count, [&](const auto& give) {
            for (const auto& [bucket, item] : given) give(bucket, item);
        });
        ASSERT_EQ(buckets.count(), static_cast<std::size_t>(count));
        EXPECT_EQ(buckets.itemCount(), given.size());
        std::size_t before = 0;
        for (int b = 0; b < count; ++b) {
            const auto items = std::as_const(buckets).of(b);
            EXPECT_EQ(std::vector<int>(items.begin(), items.end()), expected[b]);
            before += items.size();
            EXPECT_EQ(buckets.of(0, b + 1).size(), before);
        }
    }
}

}  // namespace adaptiso::testing
