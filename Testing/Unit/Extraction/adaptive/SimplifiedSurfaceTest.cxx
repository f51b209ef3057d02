#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "adaptiso/SurfaceProof/ZeroedTable.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::testing {
namespace {

using detail::CollapseCosts;
using detail::costLimitFor;

/// What a round makes: a patch ends at its first collapse above the limit.
std::int64_t collapsesWithin(const CollapseCosts& costs, double limit) {
    std::int64_t made = 0;
    for (const auto& patch : costs) {
        const auto end =
            std::find_if(patch.begin(), patch.end(), [&](double c) { return c > limit; });
        made += end - patch.begin();
    }
    return made;
}

}  // namespace

TEST(CostLimit, LeavesTheCheapestCollapses) {
    const CollapseCosts costs{{1, 2, 3}, {}, {5, 6}};
    for (int count = 0; count < 5; ++count) {
        EXPECT_EQ(collapsesWithin(costs, costLimitFor(costs, count)), count);
    }
    EXPECT_EQ(costLimitFor(costs, 5), std::numeric_limits<double>::max());
    EXPECT_EQ(costLimitFor({}, 0), std::numeric_limits<double>::max());
}

TEST(CostLimit, CountsNoCollapseBehindADearerOne) {
    // the second patch has cheap ones, but they come after one of 9
    const CollapseCosts costs{{1, 2, 3}, {9, 1, 1}};
    EXPECT_EQ(collapsesWithin(costs, costLimitFor(costs, 3)), 3);
    EXPECT_EQ(collapsesWithin(costs, costLimitFor(costs, 5)), 3);  // all three of them, or none
    EXPECT_EQ(collapsesWithin(costs, costLimitFor(costs, 6)), 6);
}

TEST(CostLimit, LeavesAsManyAsItCan) {
    std::mt19937 random(9);
    for (int n = 0; n < 200; ++n) {
        CollapseCosts costs(1 + random() % 5);
        std::int64_t all = 0;
        for (auto& patch : costs) {
            patch.resize(random() % 20);
            for (double& cost : patch) cost = static_cast<double>(1 + random() % 50);
            all += std::ssize(patch);
        }
        const auto wanted = static_cast<std::int64_t>(random() % (all + 2));
        const double limit = costLimitFor(costs, wanted);
        ASSERT_LE(collapsesWithin(costs, limit), wanted);
        if (wanted >= all) continue;
        // the next cost that a round could be limited by leads too far
        ASSERT_GT(collapsesWithin(costs, std::nextafter(limit, 100.0)), wanted);
    }
}

// Flat boxes cost nothing, and are left where the limit is nothing.
TEST(CostLimit, IsNothingWhereFlatBoxesAloneAreTooMany) {
    EXPECT_EQ(costLimitFor({{0, 0, 5}}, 1), 0);
    EXPECT_GT(costLimitFor({{0, 0, 5}}, 2), 0);
}

TEST(SimplifiedSurface, KeepsItsSamplesWhenItsStateIsReplaced) {
    detail::SimplifiedSurface surface;
    surface.samples.resize(3);
    surface.triangles.resize(7);
    EXPECT_EQ(surface.triangleCount(), 7);
    surface.state() = detail::SurfaceState();
    EXPECT_EQ(surface.triangleCount(), 0);
    EXPECT_EQ(surface.samples.size(), 3U);
}

TEST(ZeroedTable, IsZeroUntilItIsWritten) {
    detail::ZeroedTable table(1 << 16);
    table[7] = 3;
    ++table[65535];
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < 1 << 16; ++i) sum += table[i];
    EXPECT_EQ(sum, 4U);
    EXPECT_EQ(table[7], 3U);
}

}  // namespace adaptiso::testing
