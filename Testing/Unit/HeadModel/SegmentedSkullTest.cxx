#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/HeadModel/SegmentedSkull.h"

namespace adaptiso {
namespace {

constexpr double kPi = std::numbers::pi;

/// A shell of skull between two radii around 0 in voxels of 1 mm, without what `isHole` has.
template <class IsHole>
SegmentedHead shell(double inner, double outer, const IsHole& isHole) {
    constexpr std::int64_t kSide = 150;
    SegmentedHead head;
    head.grid = {{kSide, kSide, kSide}, {-74.7, -74.2, -74.9}, {}};
    for (std::int64_t k = 0; k < kSide; ++k) {
        for (std::int64_t j = 0; j < kSide; ++j) {
            for (std::int64_t i = 0; i < kSide; ++i) {
                const Vec3 p = head.grid.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                const double r = norm(p);
                head.isSkull.push_back(r >= inner && r < outer && !isHole(p) ? 1 : 0);
            }
        }
    }
    return head;
}

TEST(CompareSkull, FindsThatAThinSkullWasThickened) {
    const SegmentedHead head = shell(60, 61.5, [](const Vec3&) { return false; });
    const SkullComparison found = compareSkull(testing::icosphere(4, {0, 0, 0}, 60),
                                               testing::icosphere(4, {0, 0, 0}, 62.5), head);
    EXPECT_NEAR(found.areaMm2, 4 * kPi * 60 * 60, 200);
    // voxels of 1 mm make a shell of 1.5 mm 1 to 2 mm thick on single ways
    EXPECT_NEAR(found.medianMm, 1.5, 0.2);
    EXPECT_GT(found.thinMm, 0.7);
    EXPECT_LT(found.thinMm, found.medianMm);
    EXPECT_NEAR(found.modelMedianMm, 2.5, 0.1);
    EXPECT_GT(found.thickenedMm2, 0.8 * found.areaMm2);
    EXPECT_NEAR(found.mostThickenedMm, 1.5, 0.5);
    EXPECT_EQ(found.absentMm2, 0);
    EXPECT_FALSE(found.holeMm);
}

TEST(CompareSkull, LeavesASkullOfTheSegmentationAlone) {
    const SegmentedHead head = shell(60, 66, [](const Vec3&) { return false; });
    const SkullComparison found = compareSkull(testing::icosphere(4, {0, 0, 0}, 60),
                                               testing::icosphere(4, {0, 0, 0}, 66), head);
    EXPECT_NEAR(found.medianMm, 6, 0.2);
    EXPECT_LT(found.thickenedMm2, 0.1 * found.areaMm2);
    EXPECT_EQ(found.absentMm2, 0);
}

TEST(CompareSkull, MeasuresAHoleAndLeavesTheForamenOut) {
    // caps around +x, 25 degrees, and around -z, 15 degrees
    const double hole = std::cos(25 * kPi / 180), foramen = std::cos(15 * kPi / 180);
    const SegmentedHead head = shell(
        60, 66, [&](const Vec3& p) { return p.x > hole * norm(p) || -p.z > foramen * norm(p); });
    const SkullComparison found = compareSkull(testing::icosphere(5, {0, 0, 0}, 60),
                                               testing::icosphere(5, {0, 0, 0}, 63), head);
    const double sphere = 2 * kPi * 60 * 60;
    EXPECT_NEAR(found.largestHoleMm2, sphere * (1 - hole), 0.1 * sphere * (1 - hole));
    EXPECT_NEAR(found.absentMm2, sphere * (2 - hole - foramen),
                0.1 * sphere * (2 - hole - foramen));
    ASSERT_TRUE(found.holeMm);
    EXPECT_LT(norm(*found.holeMm - Vec3{58, 0, 0}), 2);
}

// as where the label of the right half's bone was not named
TEST(CompareSkull, AHalfWithoutSkullIsNoOpenBaseThoughItHoldsTheLowestVertex) {
    const SegmentedHead half = shell(60, 66, [](const Vec3& p) { return p.x > -2; });
    const SegmentedHead base = shell(60, 66, [](const Vec3& p) { return p.z < 2; });
    const TriangleMesh inner = testing::icosphere(5, {0, 0, 0}, 60),
                       outer = testing::icosphere(5, {0, 0, 0}, 63);
    const double sphere = 4 * kPi * 60 * 60;
    EXPECT_NEAR(compareSkull(inner, outer, half).largestHoleMm2, 0.5 * sphere, 0.05 * sphere);
    const SkullComparison open = compareSkull(inner, outer, base);
    EXPECT_NEAR(open.absentMm2, 0.5 * sphere, 0.05 * sphere);
    EXPECT_EQ(open.largestHoleMm2, 0);
}

}  // namespace
}  // namespace adaptiso
