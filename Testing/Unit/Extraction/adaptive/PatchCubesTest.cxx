#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "PatchedBall.h"

namespace adaptiso::testing {
namespace {

using detail::PatchCubes;

std::vector<std::uint32_t> between(const PatchCubes& cubes, const Index3& first,
                                   const Index3& last) {
    std::vector<std::uint32_t> numbers;
    cubes.forEachBetween(first, last, [&](std::uint32_t n) { numbers.push_back(n); });
    return numbers;
}

constexpr double kInside = 1e-5;  // boxes are a millionth of a cell smaller all round

/// x, then y, then z grow from one number to the next.
void expectNumbered(const PatchCubes& cubes, const std::vector<Index3>& inOrder) {
    for (std::uint32_t n = 0; n < inOrder.size(); ++n) {
        EXPECT_EQ(cubes.find(inOrder[n]), n);
        EXPECT_EQ(cubes.numberOf(inOrder[n]), n);
        detail::Patch patch;
        cubes.setBounds(n, patch);
        for (int a = 0; a < 3; ++a) {
            const auto low = static_cast<double>(kCut.shift[a] + kCut.side * inOrder[n][a]);
            EXPECT_NEAR(patch.lowIndex[a], low, kInside);
            EXPECT_NEAR(patch.highIndex[a], low + static_cast<double>(kCut.side), kInside);
        }
    }
}

TEST(PatchCubes, FillTheBoundingBoxOfASurface) {
    const PatchedBall ball;
    const PatchCubes cubes(ball.surface, kCut, ball.scene.frame);
    Index3 low = cubeOf(ball.surface.points[0]), high = low;
    for (const Vec3& p : ball.surface.points) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], cubeOf(p)[a]);
            high[a] = std::max(high[a], cubeOf(p)[a]);
        }
        EXPECT_EQ(cubes.cubeAt(p), cubeOf(p));
    }
    std::vector<Index3> all;
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
            for (std::int64_t x = low[0]; x <= high[0]; ++x) all.push_back({x, y, z});
        }
    }
    ASSERT_EQ(cubes.count(), all.size());
    expectNumbered(cubes, all);
    EXPECT_EQ(cubes.find({low[0] - 1, low[1], low[2]}), std::nullopt);
    EXPECT_EQ(between(cubes, low, high).size(), all.size());
    EXPECT_EQ(between(cubes, high, high), std::vector{static_cast<std::uint32_t>(all.size() - 1)});
}

// Three points at the corners of a box of 10^12 cubes.
TEST(PatchCubes, AreListedWhereTheyLieFarApart) {
    const PatchedBall ball;
    detail::SurfaceState surface;
    surface.points = {{5, 5, 5}, {120'005, 5, 5}, {5, 120'005, 120'005}};
    const PatchCubes cubes(surface, kCut, ball.scene.frame);
    const std::vector<Index3> all{{0, 0, 0}, {10'000, 0, 0}, {0, 10'000, 10'000}};
    ASSERT_EQ(cubes.count(), all.size());
    expectNumbered(cubes, all);
    EXPECT_EQ(cubes.find({1, 0, 0}), std::nullopt);
    EXPECT_EQ(between(cubes, {0, 0, 0}, {10'000, 10'000, 10'000}),
              (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(between(cubes, {1, 0, 0}, {10'000, 0, 10'000}), std::vector<std::uint32_t>{1});
    EXPECT_EQ(between(cubes, {0, 0, 0}, {0, 0, 0}), std::vector<std::uint32_t>{0});
}

TEST(PatchCubes, OfNoSurfaceAreOne) {
    const PatchedBall ball;
    EXPECT_EQ(PatchCubes(detail::SurfaceState{}, kCut, ball.scene.frame).count(), 1U);
}

}  // namespace
}  // namespace adaptiso::testing
