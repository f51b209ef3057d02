#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "PatchedBall.h"

namespace adaptiso::testing {
namespace {

using detail::PatchCubes;

/// Index coordinates are millimetres here: voxels are 1 mm.
std::vector<std::uint32_t> numbersIn(const PatchCubes& cubes, const BoundingBox& box) {
    std::vector<std::uint32_t> numbers;
    cubes.forEachIn(box, [&](std::uint32_t n) { numbers.push_back(n); });
    return numbers;
}

constexpr double kInside = 1e-5;  // boxes are a millionth of a cell smaller all round

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
    std::uint32_t number = 0;
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
            for (std::int64_t x = low[0]; x <= high[0]; ++x, ++number) {
                detail::Patch patch;
                cubes.setBounds(number, patch);
                const Index3 cube{x, y, z};
                Vec3 middle;
                for (int a = 0; a < 3; ++a) {
                    const auto least = static_cast<double>(kCut.shift[a] + kCut.side * cube[a]),
                               most = least + static_cast<double>(kCut.side);
                    EXPECT_NEAR(patch.lowIndex[a], least, kInside);
                    EXPECT_NEAR(patch.highIndex[a], most, kInside);
                    middle[a] = 0.5 * (least + most);
                }
                EXPECT_EQ(cubes.numberAt(middle), number);
                EXPECT_EQ(numbersIn(cubes, {middle, middle}), std::vector{number});
            }
        }
    }
    EXPECT_EQ(cubes.count(), number);
    EXPECT_EQ(numbersIn(cubes, {{-1e6, -1e6, -1e6}, {1e6, 1e6, 1e6}}).size(), number);
    EXPECT_TRUE(numbersIn(cubes, {{1e6, 0, 0}, {2e6, 40, 40}}).empty());
}

// Three points at the corners of a box of 10^12 cubes of the cut.
TEST(PatchCubes, AreLargerWhereTheyWouldBeTooMany) {
    const PatchedBall ball;
    detail::SurfaceState surface;
    surface.points = {{5, 5, 5}, {120'005, 5, 5}, {5, 120'005, 120'005}};
    const PatchCubes cubes(surface, kCut, ball.scene.frame);
    EXPECT_LE(cubes.count(), std::size_t{1} << 20);
    EXPECT_GE(cubes.count(), std::size_t{1} << 17);
    std::set<std::uint32_t> numbers;
    for (const Vec3& p : surface.points) {
        const std::uint32_t number = cubes.numberAt(p);
        ASSERT_LT(number, cubes.count());
        numbers.insert(number);
        detail::Patch patch;
        cubes.setBounds(number, patch);
        for (int a = 0; a < 3; ++a) {
            EXPECT_GE(p[a], patch.lowIndex[a] - kInside);
            EXPECT_LE(p[a], patch.highIndex[a] + kInside);
        }
    }
    EXPECT_EQ(numbers.size(), 3U);
}

TEST(PatchCubes, OfNoSurfaceAreOne) {
    const PatchedBall ball;
    EXPECT_EQ(PatchCubes(detail::SurfaceState{}, kCut, ball.scene.frame).count(), 1U);
}

}  // namespace
}  // namespace adaptiso::testing
