#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "Support/RandomPoints.h"
#include "adaptiso/Core/MortonOrder.h"

namespace adaptiso::testing {
namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers inOrder(const std::vector<Vec3>& points) {
    BoundingBox box{points[0], points[0]};
    for (const Vec3& p : points) box.add(p);
    return inMortonOrder(points.size(), box, [&](std::uint32_t i) { return points[i]; });
}

}  // namespace

TEST(MortonOrder, GoesThroughTheCornersOfACubeZFirst) {
    std::vector<Vec3> corners;
    for (int n = 8; n-- > 0;) {
        corners.push_back({double(n >> 2 & 1), double(n >> 1 & 1), double(n & 1)});
    }
    EXPECT_EQ(inOrder(corners), (Numbers{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(MortonOrder, KeepsTheOrderOfWhatLiesInOneCube) {
    EXPECT_EQ(inOrder({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}), (Numbers{0, 1, 2}));
    EXPECT_EQ(inOrder({{9, 0, 0}, {1e-5, 0, 0}, {0, 0, 0}}), (Numbers{1, 2, 0}));
}

// Points of one octant come one after the other, and so do those of one of its octants.
TEST(MortonOrder, LeavesNoCubeBeforeItIsDone) {
    std::mt19937 random(1);
    std::vector<Vec3> points{{-1, -1, -1}, {1, 1, 1}};
    for (int n = 0; n < 2000; ++n) points.push_back(randomPoint(random));
    const Numbers order = inOrder(points);
    for (const double side : {1.0, 0.5, 0.25}) {
        std::vector<std::array<int, 3>> cubes;
        for (const std::uint32_t i : order) {
            std::array<int, 3> cube{};
            for (int a = 0; a < 3; ++a) {
                // the last of 1,024 cubes begins at the largest coordinate
                const double place = (points[i][a] + 1) / 2 * 1023 / 1024 * 2;
                cube[a] = static_cast<int>(place / side);
            }
            if (cubes.empty() || cubes.back() != cube) cubes.push_back(cube);
        }
        std::sort(cubes.begin(), cubes.end());
        EXPECT_EQ(std::adjacent_find(cubes.begin(), cubes.end()), cubes.end()) << side;
    }
}

TEST(MortonOrder, TakesCoordinatesWhoseDifferenceIsInfinite) {
    constexpr double kLargest = std::numeric_limits<double>::max();
    Numbers order = inOrder({{kLargest, 0, 0}, {-kLargest, 0, 0}, {1, 2, 3}});
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, (Numbers{0, 1, 2}));
}

}  // namespace adaptiso::testing
