#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {
namespace {

using enum NestingRelation;
using testing::cubeMesh;
using testing::icosphere;
using testing::merged;
using testing::translated;

Side sideOf(const Vec3& p, const TriangleMesh& mesh) {
    const AabbTree tree(mesh);
    return InsideTest(mesh, tree).sideOf(p);
}

double unitRandom(std::uint64_t& state) {
    return static_cast<double>(testing::nextRandom(state) % 2001) / 1000.0 - 1;
}

TEST(InsideTest, CubeAtPointsThatRaysGoThroughCornersAndEdgesFrom) {
    const TriangleMesh cube = cubeMesh();
    const std::array<double, 7> places{-1, 0, 0.25, 0.5, 0.75, 1, 2};
    for (const double x : places) {
        for (const double y : places) {
            for (const double z : places) {
                const auto isIn = [](double c) { return c > 0 && c < 1; };
                const auto isNotOut = [](double c) { return c >= 0 && c <= 1; };
                const Side truth = isIn(x) && isIn(y) && isIn(z)               ? Side::Inside
                                   : isNotOut(x) && isNotOut(y) && isNotOut(z) ? Side::On
                                                                               : Side::Outside;
                EXPECT_EQ(sideOf({x, y, z}, cube), truth) << x << ", " << y << ", " << z;
            }
        }
    }
}

TEST(InsideTest, EveryVertexOfASmallerSphereIsInside) {
    const TriangleMesh outer = icosphere(3), inner = icosphere(3, {}, 0.9);
    const AabbTree tree(outer);
    const InsideTest test(outer, tree);
    EXPECT_TRUE(test.isClosed());
    for (const Vec3& p : inner.points) EXPECT_EQ(test.sideOf(p), Side::Inside);
    for (const Vec3& p : outer.points) EXPECT_EQ(test.sideOf(p), Side::On);
    for (const Vec3& p : inner.points) EXPECT_EQ(test.sideOf(1.3 * p), Side::Outside);
}

TEST(InsideTest, DoesNotDependOnTheWayRoundAndRemembersCavities) {
    TriangleMesh flipped = icosphere(2);
    flipOrientation(flipped);
    EXPECT_EQ(sideOf({}, flipped), Side::Inside);
    EXPECT_EQ(sideOf({}, merged({flipped, icosphere(2, {}, 0.5)})), Side::Outside);
    EXPECT_EQ(sideOf({0.7, 0, 0}, merged({flipped, icosphere(2, {}, 0.5)})), Side::Inside);
}

TEST(InsideTest, HoleIsOutvoted) {
    for (const TriangleMesh& broken :
         {testing::withHole(icosphere(2)), testing::withNanCoordinate(icosphere(2))}) {
        const AabbTree tree(broken);
        const InsideTest test(broken, tree);
        EXPECT_FALSE(test.isClosed());
        for (const Vec3& p : icosphere(2, {}, 0.4).points) {
            EXPECT_EQ(test.sideOf(p), Side::Inside);
            EXPECT_EQ(test.sideOf(4 * p), Side::Outside);
        }
    }
}

TEST(TriangleDistance, KnownPairs) {
    const Corners floor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
    const auto distance = [&](const Corners& other) {
        const NearestPoints there = triangleDistance(floor, other);
        const NearestPoints back = triangleDistance(other, floor);
        EXPECT_DOUBLE_EQ(there.distanceMm, back.distanceMm);
        // the points are as far apart as is said, to a few roundings
        EXPECT_NEAR(norm(there.pointA - there.pointB), there.distanceMm, 1e-14);
        return there.distanceMm;
    };
    EXPECT_EQ(distance({{{1, 1, 2}, {9, 9, 5}, {-9, 5, 7}}}), 2);    // corner over face
    EXPECT_EQ(distance({{{-3, 1, 0}, {-3, 2, 1}, {-5, 1, 3}}}), 3);  // corner to side
    EXPECT_EQ(distance({{{4, 3, 0}, {9, 9, 0}, {9, 3, 0}}}),         // corner to the long side
              3 / std::sqrt(2.0));
    EXPECT_EQ(distance({{{2, -1, 1}, {2, 9, 1}, {2, 4, 9}}}), 1);  // side over face
    EXPECT_EQ(distance({{{-5, -3, 1}, {5, -3, 1}, {0, -3, 9}}}),   // side to side
              std::sqrt(10.0));
    EXPECT_EQ(distance({{{1, 1, -1}, {1, 2, 2}, {2, 1, 2}}}), 0);  // through
    EXPECT_EQ(distance({{{4, 0, 0}, {9, 0, 0}, {9, 0, 9}}}), 0);   // a corner of both
    EXPECT_EQ(distance(floor), 0);
}

TEST(TriangleDistance, IsNeverBeatenBySamples) {
    std::uint64_t state = 5;
    for (int n = 0; n < 300; ++n) {
        Corners a, b;
        for (Vec3& p : a) p = {unitRandom(state), unitRandom(state), unitRandom(state)};
        for (Vec3& p : b) p = {unitRandom(state) + 1, unitRandom(state), unitRandom(state)};
        double sampled = std::numeric_limits<double>::infinity();
        constexpr int kSteps = 24;
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; i + j <= kSteps; ++j) {
                const Vec3 p = a[0] + static_cast<double>(i) / kSteps * (a[1] - a[0]) +
                               static_cast<double>(j) / kSteps * (a[2] - a[0]);
                sampled = std::min(sampled, norm(p - closestPointOnTriangle(p, b[0], b[1], b[2])));
            }
        }
        const double distance = triangleDistance(a, b).distanceMm;
        EXPECT_LE(distance, sampled + 1e-12);
        // a point of `a` is at most a step of its longest possible side from a sample
        EXPECT_GE(distance, sampled - 2 * std::sqrt(3.0) / kSteps);
    }
}

/// All pairs, one after the other.
double bruteForceGap(const TriangleMesh& a, const TriangleMesh& b) {
    double gap = std::numeric_limits<double>::infinity();
    for (const Triangle& s : a.triangles) {
        for (const Triangle& t : b.triangles) {
            const Corners p{a.points[s[0]], a.points[s[1]], a.points[s[2]]};
            const Corners q{b.points[t[0]], b.points[t[1]], b.points[t[2]]};
            gap = std::min(gap, triangleDistance(p, q).distanceMm);
        }
    }
    return gap;
}

TEST(SurfaceGap, IsTheSmallestOfAllPairs) {
    std::uint64_t state = 9;
    for (int n = 0; n < 12; ++n) {
        TriangleMesh a = icosphere(2, {}, 1), b = icosphere(2, {}, 1.3);
        for (Vec3& p : a.points) p = (1 + 0.05 * unitRandom(state)) * p;
        for (Vec3& p : b.points) p = (1 + 0.05 * unitRandom(state)) * p;
        if (n % 2 == 1) b = translated(icosphere(1), {3, 0.2 * n, 1});  // side by side
        const AabbTree treeA(a), treeB(b);
        const SurfaceGap gap = surfaceGap(a, treeA, b, treeB);
        EXPECT_EQ(gap.nearest.distanceMm, bruteForceGap(a, b));
        EXPECT_GE(gap.triangleA, 0);
    }
}

TEST(SurfaceGap, OfNothingIsInfinite) {
    const TriangleMesh cube = cubeMesh(), nothing;
    const AabbTree tree(cube), empty(nothing);
    EXPECT_EQ(surfaceGap(cube, tree, nothing, empty).triangleA, -1);
    EXPECT_EQ(surfaceGap(nothing, empty, cube, tree).triangleA, -1);
}

TEST(Nesting, CubesInEachOther) {
    const TriangleMesh inner = cubeMesh({1, 1, 1}, {3, 3, 3}), outer = cubeMesh({}, {6, 6, 6});
    const NestingReport report = checkNesting(inner, outer);
    EXPECT_EQ(report.relation, Nested);
    EXPECT_TRUE(report.isStrictlyNested());
    EXPECT_EQ(report.innerVertices, 8);
    EXPECT_EQ(report.innerVerticesNotInside, 0);
    EXPECT_EQ(report.outerVerticesInside, 0);
    EXPECT_EQ(report.gap.nearest.distanceMm, 1);

    const NestingReport swapped = checkNesting(outer, inner);
    EXPECT_EQ(swapped.relation, Swapped);
    EXPECT_EQ(swapped.innerVerticesNotInside, 8);
    EXPECT_EQ(swapped.gap.nearest.distanceMm, 1);
}

TEST(Nesting, TouchingIsCrossing) {
    const TriangleMesh outer = cubeMesh({}, {6, 6, 6});
    for (const Vec3& low : {Vec3{0, 1, 1}, Vec3{0, 0, 0}, Vec3{-2, 1, 1}}) {
        const NestingReport report =
            checkNesting(cubeMesh(low, low + Vec3{2, 2, 2}), outer, {.maxPairs = 2});
        EXPECT_EQ(report.relation, Crossing);
        EXPECT_GT(report.crossingPairs, 2);
        EXPECT_EQ(report.pairs.size(), 2u);
        EXPECT_EQ(report.gap.nearest.distanceMm, 0);
    }
}

TEST(Nesting, TheSameSurfaceIsIdenticalWhateverItsNumbers) {
    const TriangleMesh sphere = icosphere(2, {}, 80);
    EXPECT_EQ(checkNesting(sphere, sphere).relation, Identical);
    TriangleMesh renumbered = sphere;
    std::reverse(renumbered.points.begin(), renumbered.points.end());
    const auto last = static_cast<VertexId>(sphere.points.size()) - 1;
    for (Triangle& t : renumbered.triangles) t = {last - t[1], last - t[0], last - t[2]};
    std::reverse(renumbered.triangles.begin(), renumbered.triangles.end());
    EXPECT_EQ(checkNesting(sphere, renumbered).relation, Identical);
    renumbered.points[3] = 1.1 * renumbered.points[3];
    EXPECT_EQ(checkNesting(sphere, renumbered).relation, Crossing);
}

TEST(Nesting, ASurfaceThatIsThereTwiceHasTheInsideOfOne) {
    const TriangleMesh inner = icosphere(2, {}, 80), outer = icosphere(2, {}, 92);
    const TriangleMesh twice = merged({outer, outer});
    EXPECT_EQ(checkNesting(inner, twice).relation, Nested);
    EXPECT_EQ(checkNesting(merged({inner, inner}), outer).relation, Nested);
    EXPECT_EQ(checkNesting(outer, twice).relation, Identical);
}

TEST(Nesting, ApartAndMixed) {
    const TriangleMesh cube = cubeMesh({}, {6, 6, 6}), small = cubeMesh({1, 1, 1}, {2, 2, 2});
    const TriangleMesh away = translated(small, {8, 0, 0});
    const NestingReport apart = checkNesting(away, cube);
    EXPECT_EQ(apart.relation, Apart);
    EXPECT_EQ(apart.gap.nearest.distanceMm, 3);
    const NestingReport mixed = checkNesting(merged({small, away}), cube);
    EXPECT_EQ(mixed.relation, Mixed);
    EXPECT_EQ(mixed.innerVerticesNotInside, 8);
    EXPECT_EQ(mixed.firstNotInside, 8);
    EXPECT_EQ(checkNesting({}, cube).relation, Unknown);
    // a piece of the outer surface inside the inner one
    EXPECT_EQ(checkNesting(cube, merged({cubeMesh({-1, -1, -1}, {9, 9, 9}), small})).relation,
              Mixed);
}

TEST(Nesting, VertexThatPokesOutIsCountedAndMeasured) {
    TriangleMesh inner = icosphere(3, {}, 80);
    inner.points[5] = 88.0 / 80 * inner.points[5];
    const TriangleMesh outer = icosphere(3, {}, 86);
    const NestingReport report = checkNesting(inner, outer);
    EXPECT_EQ(report.relation, Crossing);
    EXPECT_EQ(report.innerVerticesNotInside, 1);
    EXPECT_EQ(report.firstNotInside, 5);
    EXPECT_NEAR(report.farthestOutMm, 2, 1e-12);  // over the outer vertex: that is nearest
}

TEST(Nesting, DentBetweenVerticesIsFound) {
    // the corner (3, 3, -1) of a pyramid hangs through the inner cube's top at z = 0
    const TriangleMesh inner = cubeMesh({0, 0, -6}, {6, 6, 0});
    TriangleMesh outer = cubeMesh({-1, -1, -7}, {7, 7, 2});
    outer.triangles.erase(outer.triangles.begin() + 2, outer.triangles.begin() + 4);  // its top
    outer.points.push_back({3, 3, -1});
    for (const auto& [a, b] : {std::pair{4, 5}, {5, 7}, {7, 6}, {6, 4}}) {
        outer.triangles.push_back({a, b, 8});
    }
    const NestingReport report = checkNesting(inner, outer);
    EXPECT_EQ(report.relation, Crossing);
    EXPECT_EQ(report.innerVerticesNotInside, 0);
    EXPECT_EQ(report.outerVerticesInside, 1);
}

TEST(Nesting, BrokenMeshesAreSurvived) {
    const TriangleMesh inner = icosphere(2, {}, 1), outer = icosphere(2, {}, 2);
    for (const TriangleMesh& broken :
         {testing::withHole(outer), testing::withNanCoordinate(outer),
          testing::withRepeatedIndex(outer), testing::withUnusedVertex(outer),
          testing::withZeroAreaTriangle(outer), testing::withFlippedTriangle(outer)}) {
        EXPECT_EQ(checkNesting(inner, broken).relation, Nested);
        EXPECT_EQ(checkNesting(broken, inner).relation, Swapped);
    }
    EXPECT_THROW(checkNesting(inner, testing::withIndexOutOfRange(outer)), InvalidInput);
    EXPECT_THROW(checkNesting(inner, outer, {.maxPairs = -1}), InvalidInput);
}

TEST(Nesting, IsTheSameWhateverTheNumberOfThreads) {
    const TriangleMesh inner = icosphere(5, {}, 80), outer = icosphere(5, {1, 0, 0}, 82);
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        return checkNesting(inner, outer);
    };
    const NestingReport one = run(1), two = run(2);
    EXPECT_EQ(one.gap.nearest.distanceMm, two.gap.nearest.distanceMm);
    EXPECT_EQ(one.gap.triangleA, two.gap.triangleA);
    EXPECT_EQ(one.gap.triangleB, two.gap.triangleB);
    EXPECT_EQ(one.gap.nearest.pointA, two.gap.nearest.pointA);
    EXPECT_EQ(one.relation, two.relation);
}

}  // namespace
}  // namespace adaptiso
