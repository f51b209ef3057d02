#include <gtest/gtest.h>

#include <cmath>

#include "Support/AnalyticVolumes.h"
#include "Surfaces.h"
#include "adaptive/mesh/MetricFrame.h"

namespace adaptiso::testing {
namespace {

/// In terms of 1: numbers of about ten, some operations on them.
constexpr double kRounding = 1e-12;

}  // namespace

TEST(MetricFrame, HasTheDistancesOfPhysicalSpace) {
    std::mt19937 random(1);
    const Vec3 spacing{0.7, 1.3, 2.5};
    for (const ImageGeometry& geometry :
         {centredGeometry({9, 9, 9}, spacing), obliqueGeometry({9, 9, 9}, spacing),
          shearedGeometry({9, 9, 9}, spacing), mirroredGeometry({9, 9, 9}, spacing)}) {
        const detail::MetricFrame frame(geometry);
        EXPECT_NEAR(frame.voxelMm(), std::cbrt(std::abs(geometry.voxelVolumeMm3())), kRounding);
        for (int n = 0; n < 100; ++n) {
            const Vec3 p = randomPoint(random, 9), q = randomPoint(random, 9),
                       r = randomPoint(random, 9);
            const auto inFrame = [&](const Vec3& index) { return frame.fromIndex(index); };
            const auto inSpace = [&](const Vec3& index) { return geometry.toPhysical(index); };
            EXPECT_NEAR(norm(inFrame(p) - inFrame(q)), norm(inSpace(p) - inSpace(q)),
                        100 * kRounding);
            EXPECT_NEAR(norm(areaVector2(inFrame(p), inFrame(q), inFrame(r))),
                        norm(areaVector2(inSpace(p), inSpace(q), inSpace(r))), 1e4 * kRounding);
            EXPECT_NEAR(norm(frame.toIndex(inFrame(p)) - p), 0, 100 * kRounding);
        }
    }
}

TEST(MetricFrame, FitsTheLattice) {
    for (const ImageGeometry& geometry :
         {obliqueGeometry({9, 9, 9}, {1, 2, 3}), mirroredGeometry({9, 9, 9}, {1, 2, 3}),
          shearedGeometry({9, 9, 9}, {1, 2, 3})}) {
        const detail::MetricFrame frame(geometry);
        EXPECT_EQ(frame.fromIndex({0, 0, 0}), (Vec3{0, 0, 0}));
        const Vec3 i = frame.fromIndex({1, 0, 0}), j = frame.fromIndex({0, 1, 0}),
                   k = frame.fromIndex({0, 0, 1});
        EXPECT_NEAR(norm(i - Vec3{norm(i), 0, 0}), 0, kRounding);
        EXPECT_NEAR(j.z, 0, kRounding);
        EXPECT_GT(j.y, 0);
        EXPECT_GT(dot(cross(i, j), k), 0);  // orientation of index space, mirrored or not
    }
}

TEST(MetricFrame, KnowsTheLeastDistanceBetweenPlanesOfSamples) {
    // steps of 2 mm along i and j at 60 degrees: their planes are sqrt(3) mm apart, those of k 2.5
    ImageGeometry geometry;
    geometry.indexToPhysical = {{{{2, 0, 0}, {1, std::sqrt(3.0), 0}, {0, 0, 2.5}}}};
    EXPECT_NEAR(detail::MetricFrame(geometry).narrowestMm(), std::sqrt(3.0), kRounding);
    EXPECT_NEAR(detail::MetricFrame(obliqueGeometry({9, 9, 9}, {3, 0.5, 2})).narrowestMm(), 0.5,
                kRounding);
}

}  // namespace adaptiso::testing
