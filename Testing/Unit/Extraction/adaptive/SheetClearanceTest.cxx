#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "Surfaces.h"
#include "adaptive/bricks/SheetClearance.h"

namespace adaptiso::testing {
namespace {

using detail::SheetClearance;

}  // namespace

TEST(SheetClearance, IsTheDistanceToASheetThatFacesElsewhere) {
    // two sheets 0.5 apart that face away from each other, and a third 0.9 over them
    std::vector<Vec3> points, normals;
    for (int i = 0; i < 300; ++i) {
        const int layer = i % 3;
        points.push_back({0.25 * (i / 3 % 10), 0.25 * (i / 30), layer == 2 ? 1.4 : 0.5 * layer});
        normals.push_back({0, 0, layer == 1 ? 3.0 : -3.0});
    }
    std::vector<std::uint8_t> clearance(points.size(), 0);
    clearance.front() = SheetClearance::kAlone;
    SheetClearance::fillIn(points, normals, unitFrame(), clearance);
    EXPECT_EQ(clearance.front(), SheetClearance::kAlone);
    for (std::size_t i = 1; i < clearance.size(); ++i) {
        EXPECT_NEAR(clearance[i], (i % 3 == 2 ? 0.9 : 0.5) * SheetClearance::kParts, 1) << i;
    }
}

TEST(SheetClearance, IsNotLimitedByItsOwnSheet) {
    std::vector<Vec3> points, normals;
    for (int i = 0; i < 100; ++i) {
        points.push_back({0.1 * (i % 10), 0.1 * (i / 10), 0});
        normals.push_back({0, 0.5 * std::sin(0.1 * i), 1});  // bent by half a right angle at most
    }
    std::vector<std::uint8_t> clearance(points.size(), 0);
    SheetClearance::fillIn(points, normals, unitFrame(), clearance);
    EXPECT_EQ(std::count(clearance.begin(), clearance.end(), SheetClearance::kAlone), 100);
}

// In a lattice whose planes are 0.5, 1 and 2 mm apart a sheet counts up to 0.5 mm.
TEST(SheetClearance, IsTheNearestOfAllPoints) {
    ImageGeometry geometry;
    geometry.indexToPhysical = Mat3::diagonal(1, 0.5, 2);
    const detail::MetricFrame frame(geometry);
    std::mt19937 random(6);
    std::vector<Vec3> points, normals;
    for (int i = 0; i < 800; ++i) {
        points.push_back(randomPoint(random, 2));
        normals.push_back({0, 0, i % 2 == 0 ? 1.0 : -1.0});
    }
    std::vector<std::uint8_t> clearance(points.size(), 0);
    SheetClearance::fillIn(points, normals, frame, clearance);
    int alone = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double least = 0.5;
        for (std::size_t j = 1 - i % 2; j < points.size(); j += 2) {
            least = std::min(least, norm(points[i] - points[j]));
        }
        if (std::abs(least - 0.5) < 1e-6) {
            EXPECT_EQ(clearance[i], SheetClearance::kAlone) << i;
            ++alone;
        } else {
            EXPECT_NEAR(clearance[i], SheetClearance::kParts * least / 0.5, 1) << i;
        }
    }
    EXPECT_GT(alone, 20);
    EXPECT_LT(alone, 780);
}

}  // namespace adaptiso::testing
