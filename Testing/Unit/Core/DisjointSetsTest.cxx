#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "adaptiso/Core/Buckets.h"

namespace adaptiso::testing {

TEST(DisjointSets, AreNamedByTheirSmallestMember) {
    DisjointSets sets(6);
    sets.join(5, 3);
    sets.join(4, 1);
    sets.join(3, 4);
    EXPECT_EQ(sets.find(5), 1);
    EXPECT_EQ(std::move(sets).names(), (std::vector<std::int64_t>{0, 1, 2, 1, 1, 1}));
}

TEST(DisjointSets, DoNotDependOnTheOrderOfJoining) {
    std::mt19937 random(2);
    for (int round = 0; round < 100; ++round) {
        const std::int64_t n = 1 + random() % 40;
        std::vector<std::pair<std::int64_t, std::int64_t>> pairs(random() % 40);
        for (auto& [a, b] : pairs) a = random() % n, b = random() % n;
        // what is connected, by spreading the smallest number along the pairs until nothing changes
        std::vector<std::int64_t> expected(n);
        for (std::int64_t i = 0; i < n; ++i) expected[i] = i;
        for (std::int64_t i = 0; i < n; ++i) {
            for (const auto& [a, b] : pairs) {
                expected[a] = expected[b] = std::min(expected[a], expected[b]);
            }
        }
        std::shuffle(pairs.begin(), pairs.end(), random);
        DisjointSets sets(n);
        for (const auto& [a, b] : pairs) sets.join(a, b);
        EXPECT_EQ(std::move(sets).names(), expected);
    }
}

}  // namespace adaptiso::testing
