#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "adaptiso-giant/GrowingComponents.h"
#include "adaptiso/Core/Buckets.h"

namespace adaptiso::giant {
namespace {

TEST(GrowingComponents, AreThoseOfAUnionFindThatForgetsNothing) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 200; ++trial) {
        constexpr int kParts = 120, kWindow = 12;  // parts that are held at once
        DisjointSets sets(kParts);
        GrowingComponents components;
        std::vector<std::pair<std::uint32_t, std::int64_t>> held;  // part, its number
        for (std::int64_t n = 0; n < kParts; ++n) {
            held.emplace_back(components.add({1, 2 * n, 1.0, static_cast<double>(n - 20), n}), n);
            for (int joins = static_cast<int>(random() % 3); joins-- > 0;) {
                const auto& [a, first] = held[random() % held.size()];
                const auto& [b, second] = held[random() % held.size()];
                components.join(a, b);
                sets.join(first, second);
            }
            if (held.size() < kWindow) continue;
            const std::size_t gone = random() % held.size();
            components.drop(held[gone].first);
            held.erase(held.begin() + static_cast<std::ptrdiff_t>(gone));
        }
        components.finishAll();
        std::map<std::int64_t, double> volumes;
        for (std::int64_t n = 0; n < kParts; ++n) {
            volumes[sets.find(n)] += static_cast<double>(n - 20);
        }
        ASSERT_EQ(components.totals().count, std::ssize(volumes));
        ASSERT_EQ(components.totals().vertices, kParts);
        ASSERT_EQ(components.totals().areaMm2, kParts);
        double last = 1e9;
        for (const GiantComponent& component : components.largest()) {
            ASSERT_EQ(component.volumeMm3, volumes.at(component.firstPart));
            ASSERT_LE(component.volumeMm3, last);
            last = component.volumeMm3;
        }
    }
}

TEST(GrowingComponents, KeepTheLargestAndCountAll) {
    GrowingComponents components;
    constexpr int kCount = 5000;
    for (int n = 0; n < kCount; ++n) {
        components.drop(components.add({10, 16, 1, static_cast<double>(n % 4000), n}));
    }
    components.finishAll();
    EXPECT_EQ(components.totals().count, kCount);
    ASSERT_EQ(components.largest().size(), GrowingComponents::kMostKept);
    EXPECT_EQ(components.largest().front().volumeMm3, 3999);
    EXPECT_EQ(components.largest().back().volumeMm3, 3000);
}

}  // namespace
}  // namespace adaptiso::giant
