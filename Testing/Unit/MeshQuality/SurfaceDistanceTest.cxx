#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {
namespace {

using testing::icosphere;
using testing::planeMesh;

TEST(SurfaceDistance, IsZeroFromAMeshToItself) {
    const TriangleMesh mesh = testing::torusMesh(60, 40, 50, 20);
    const DistanceReport report = surfaceDistance(mesh, mesh, {.samples = 20000});
    // Coordinates of 70 mm are rounded by 1e-14; a foot point takes some ten operations.
    EXPECT_LE(report.combined.maxMm, 1e-12);
    EXPECT_LE(report.combined.meanNormalDeviationDeg, 1e-3);  // a sample on an edge may pick either
    EXPECT_EQ(report.aToB.samples, 20000);
    EXPECT_EQ(report.combined.samples, 40000);
}

TEST(SurfaceDistance, OfShiftedPlanesIsTheShift) {
    const DistanceReport report =
        surfaceDistance(planeMesh(7, 10), planeMesh(3, 10, 2.5), {.samples = 1000});
    for (const DistanceStatistics& s : {report.aToB, report.bToA, report.combined}) {
        EXPECT_DOUBLE_EQ(s.meanMm, 2.5);
        EXPECT_DOUBLE_EQ(s.rmsMm, 2.5);
        EXPECT_DOUBLE_EQ(s.p95Mm, 2.5);
        EXPECT_DOUBLE_EQ(s.p99Mm, 2.5);
        EXPECT_DOUBLE_EQ(s.maxMm, 2.5);
        EXPECT_EQ(s.meanNormalDeviationDeg, 0);
    }
}

TEST(SurfaceDistance, OfConcentricSpheresIsTheGap) {
    const DistanceReport report =
        surfaceDistance(icosphere(5, {3, 2, 1}, 10), icosphere(5, {3, 2, 1}, 12));
    // 20480 triangles a sphere: chords lie within h^2 / (8 r) = 0.2 % of r inside the sphere.
    EXPECT_NEAR(report.aToB.meanMm, 2, 0.03);
    EXPECT_NEAR(report.bToA.meanMm, 2, 0.03);
    EXPECT_NEAR(report.combined.maxMm, 2, 0.04);
    EXPECT_LT(report.combined.meanNormalDeviationDeg, 2);  // facets are 2 degrees apart
}

TEST(SurfaceDistance, IsOneSidedWhereASurfaceIsPartOfAnother) {
    // A small square within a large one: nothing from small to large; the far corner of the large
    // one is 3 * sqrt 2 from the small one's corner.
    const DistanceReport report =
        surfaceDistance(planeMesh(2, 1), planeMesh(4, 4), {.samples = 5000});
    EXPECT_LE(report.aToB.maxMm, 1e-15);
    EXPECT_DOUBLE_EQ(report.bToA.maxMm, 3 * std::numbers::sqrt2);  // a vertex: found exactly
    EXPECT_EQ(report.bToA.maxPointMm, (Vec3{4, 4, 0}));
    EXPECT_EQ(report.combined.maxMm, report.bToA.maxMm);
    EXPECT_EQ(report.combined.maxPointMm, report.bToA.maxPointMm);
    const DistanceReport oneSided =
        surfaceDistance(planeMesh(2, 1), planeMesh(4, 4), {.samples = 5000, .isSymmetric = false});
    EXPECT_EQ(oneSided.bToA.samples, 0);
    EXPECT_EQ(oneSided.combined.maxMm, oneSided.aToB.maxMm);
}

TEST(SurfaceDistance, StatisticsOfATiltedPlaneAreThoseOfAnEvenSpread) {
    // Heights over a square tilted by 45 degrees spread evenly over 0...10 mm; the plane below
    // reaches far enough for every foot point.
    TriangleMesh tilted = planeMesh(9, 10);
    for (Vec3& p : tilted.points) p.z = p.x;
    const TriangleMesh floor = testing::translated(planeMesh(5, 40), {-15, -15, 0});
    const DistanceReport report =
        surfaceDistance(tilted, floor, {.samples = 20000, .isSymmetric = false});
    // Stratified by area: the mean of n even samples errs by far less than 1 / sqrt(n) = 0.7 %.
    EXPECT_NEAR(report.aToB.meanMm, 5, 0.01);
    EXPECT_NEAR(report.aToB.rmsMm, 10 / std::sqrt(3.0), 0.01);
    EXPECT_NEAR(report.aToB.p95Mm, 9.5, 0.02);
    EXPECT_NEAR(report.aToB.p99Mm, 9.9, 0.02);
    EXPECT_DOUBLE_EQ(report.aToB.maxMm, 10);
    EXPECT_NEAR(report.aToB.meanNormalDeviationDeg, 45, 1e-9);  // rounding of atan2
    EXPECT_NEAR(report.aToB.p95NormalDeviationDeg, 45, 1e-9);
}

TEST(SurfaceDistance, SamplesFollowTheAreaWhateverTheTriangles) {
    // Half of the square in two triangles, half in 2 * 40 * 40: the mean height is that of the
    // square, not that of the many small triangles.
    TriangleMesh coarse = planeMesh(1, 1);
    for (Vec3& p : coarse.points) p.z = 1;
    const TriangleMesh fine = testing::translated(planeMesh(40, 1), {1, 0, 3});
    const TriangleMesh floor = testing::translated(planeMesh(1, 10), {-4, -4, 0});
    const DistanceReport report = surfaceDistance(testing::merged({coarse, fine}), floor,
                                                  {.samples = 10000, .isSymmetric = false});
    EXPECT_NEAR(report.aToB.meanMm, 2, 1e-3);  // one sample of 10000 may fall on either side
}

TEST(SurfaceDistance, MaximumHoldsEveryVertexEvenWithOneSample) {
    TriangleMesh spike = planeMesh(10, 10);
    spike.points[60].z = 4;  // (5, 5)
    const DistanceReport report =
        surfaceDistance(spike, planeMesh(10, 10), {.samples = 1, .isSymmetric = false});
    EXPECT_DOUBLE_EQ(report.aToB.maxMm, 4);
    EXPECT_EQ(report.aToB.maxPointMm, (Vec3{5, 5, 4}));
}

TEST(SurfaceDistance, UnusedVerticesDoNotCount) {
    const DistanceReport report = surfaceDistance(testing::withUnusedVertex(testing::cubeMesh()),
                                                  testing::cubeMesh(), {.samples = 100});
    EXPECT_LE(report.combined.maxMm, 1e-15);
}

TEST(SurfaceDistance, RefusesWhatCannotBeMeasured) {
    const TriangleMesh cube = testing::cubeMesh();
    EXPECT_THROW(surfaceDistance(cube, cube, {.samples = 0}), InvalidInput);
    EXPECT_THROW(surfaceDistance({}, cube), InvalidInput);
    EXPECT_THROW(surfaceDistance(cube, {}), InvalidInput);
    EXPECT_THROW(surfaceDistance(testing::withNanCoordinate(cube), cube), InvalidInput);
    EXPECT_THROW(surfaceDistance(cube, testing::withIndexOutOfRange(cube)), InvalidInput);
}

TEST(SurfaceDistance, TellsItsProgress) {
    std::vector<double> told;
    DistanceOptions options{.samples = 10};
    options.progress = [&](std::string_view, double fraction) { told.push_back(fraction); };
    surfaceDistance(testing::cubeMesh(), testing::cubeMesh(), options);
    EXPECT_EQ(told, (std::vector<double>{0, 0.5, 1}));
}

TEST(SurfaceDistance, IsTheSameWhateverTheNumberOfThreads) {
    const TriangleMesh a = icosphere(4), b = icosphere(4, {0.1, 0, 0}, 1.1);
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        return surfaceDistance(a, b, {.samples = 30000}).combined;
    };
    const DistanceStatistics one = run(1), two = run(2);
    EXPECT_EQ(one.meanMm, two.meanMm);
    EXPECT_EQ(one.rmsMm, two.rmsMm);
    EXPECT_EQ(one.p95Mm, two.p95Mm);
    EXPECT_EQ(one.maxMm, two.maxMm);
    EXPECT_EQ(one.maxPointMm, two.maxPointMm);
    EXPECT_EQ(one.meanNormalDeviationDeg, two.meanNormalDeviationDeg);
}

}  // namespace
}  // namespace adaptiso
