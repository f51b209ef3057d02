#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "SmoothShapes.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

using namespace adaptiso::testing;

using Surfaces = std::vector<TriangleMesh>;

NestOptions withGap(double mm) {
    NestOptions options;
    options.minGapsMm = {mm};
    return options;
}

/// What every result must be; the gaps are asked of the checker, not of the result.
void expectNested(const NestResult& result, std::size_t surfaces, double gapMm) {
    for (const Finding& finding : result.findings) ADD_FAILURE() << finding.what;
    ASSERT_EQ(result.surfaces.size(), surfaces);
    ASSERT_EQ(result.gaps.size() + 1, surfaces);
    for (std::size_t n = 0; n < result.surfaces.size(); ++n) {
        expectSound(result.surfaces[n]);
        EXPECT_EQ(findSelfIntersections(result.surfaces[n]).pairCount, 0);
        if (n == 0) continue;
        const NestingReport report = checkNesting(result.surfaces[n - 1], result.surfaces[n]);
        EXPECT_TRUE(report.isStrictlyNested()) << toString(report.relation);
        EXPECT_GE(report.gap.nearest.distanceMm, gapMm);
        EXPECT_EQ(report.gap.nearest.distanceMm, result.gaps[n - 1].mm);
    }
}

/// `mesh` with a bump towards `direction`: within `widthMm` of the tip, up to `heightMm` (negative:
/// a dent).
TriangleMesh withBump(TriangleMesh mesh, const Vec3& tipMm, double widthMm, double heightMm) {
    for (Vec3& p : mesh.points) {
        const double x = norm(p - tipMm) / widthMm;
        p += heightMm * std::exp(-x * x) * normalized(tipMm);
    }
    mesh.normals.clear();
    return mesh;
}

TriangleMesh inner() {
    return icosphere(4, {}, 80);
}

TEST(NestSurfaces, LeavesWellNestedSurfacesAsTheyAre) {
    const Surfaces spheres{inner(), icosphere(4, {}, 86), icosphere(4, {}, 92)};
    const NestResult result = nestSurfaces(spheres, withGap(5));
    expectNested(result, 3, 5);
    if (HasFatalFailure()) return;
    EXPECT_EQ(result.surfaces, spheres);
    for (const SurfaceMove& move : result.moves) EXPECT_EQ(move.movedVertices, 0);
    // Spheres of the same directions: the gap is that of the faces' centres, a little under 6 mm.
    EXPECT_NEAR(result.gaps[0].mm, 6, 0.05);
}

TEST(NestSurfaces, OpensAThinGap) {
    const NestResult result = nestSurfaces({inner(), icosphere(4, {}, 80.5)}, withGap(2));
    expectNested(result, 2, 2);
    if (HasFatalFailure()) return;
    EXPECT_EQ(result.moves[0].movedVertices, 0);
    EXPECT_LE(result.moves[1].maximumMm, 2);  // 1.5 mm were missing
    for (const Vec3& p : result.surfaces[1].points) EXPECT_NEAR(norm(p), 82.1, 0.15);
}

TEST(NestSurfaces, PartsSurfacesThatTouch) {
    // The outer sphere is moved until it touches the inner one at a vertex of both, to rounding.
    Surfaces spheres{inner(), icosphere(4, {}, 86)};
    spheres[1] = translated(spheres[1], spheres[0].points[7] - spheres[1].points[7]);
    spheres[1].points[7] = spheres[0].points[7];
    ASSERT_EQ(checkNesting(spheres[0], spheres[1]).relation, NestingRelation::Crossing);
    const NestResult result = nestSurfaces(spheres, withGap(2));
    expectNested(result, 2, 2);
    if (HasFatalFailure()) return;
    EXPECT_LE(result.moves[1].maximumMm, 4);
}

TEST(NestSurfaces, PushesOutWhatPokesThrough) {
    // A bump of 10 mm on the inner surface stands 4 mm out of the next.
    const NestResult result =
        nestSurfaces({withBump(inner(), {0, 0, 80}, 15, 10), icosphere(4, {}, 86)}, withGap(2));
    expectNested(result, 2, 2);
    if (HasFatalFailure()) return;
    EXPECT_EQ(result.moves[0].movedVertices, 0);
    EXPECT_GE(result.moves[1].maximumMm, 6);  // 4 out, 2 more for the gap
    EXPECT_LE(result.moves[1].maximumMm, 9);
    // Moved locally: the other end is where it was.
    const TriangleMesh before = icosphere(4, {}, 86);
    for (std::size_t v = 0; v < before.points.size(); ++v) {
        if (before.points[v].z >= 0) continue;
        EXPECT_EQ(result.surfaces[1].points[v], before.points[v]);
    }
}

TEST(NestSurfaces, PushesOutADentOfTheOuterSurface) {
    const NestResult result =
        nestSurfaces({inner(), withBump(icosphere(4, {}, 86), {0, 86, 0}, 20, -12)}, withGap(2));
    expectNested(result, 2, 2);
    if (HasFatalFailure()) return;
}

TEST(NestSurfaces, PushesAFaceOffASpike) {
    // One vertex of the inner surface pokes through the middle of a face of a coarse outer one:
    // no vertex of the outer surface is near.
    TriangleMesh spiked = inner();
    const TriangleMesh coarse = icosphere(2, {}, 90);
    const auto [a, b, c] = coarse.triangles[0];
    const Vec3 middle = 1.0 / 3 * (coarse.points[a] + coarse.points[b] + coarse.points[c]);
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < spiked.points.size(); ++v) {
        if (norm(spiked.points[v] - middle) < norm(spiked.points[nearest] - middle)) nearest = v;
    }
    spiked.points[nearest] = (92 / 80.0) * spiked.points[nearest];
    spiked.normals.clear();
    expectNested(nestSurfaces({spiked, coarse}, withGap(1)), 2, 1);
}

TEST(NestSurfaces, NestsThreeThatAllCross) {
    const NestResult result = nestSurfaces(
        {inner(), icosphere(4, {3, 0, 0}, 81), icosphere(4, {-2, 3, 0}, 82)}, withGap(2));
    expectNested(result, 3, 2);
    if (HasFatalFailure()) return;
    EXPECT_EQ(result.moves[0].movedVertices, 0);
}

TEST(NestSurfaces, TakesAGapForEachPair) {
    NestOptions options;
    options.minGapsMm = {3, 1.5};
    const NestResult result =
        nestSurfaces({inner(), icosphere(4, {}, 81), icosphere(4, {}, 82)}, options);
    expectNested(result, 3, 1.5);
    if (HasFatalFailure()) return;
    EXPECT_GE(result.gaps[0].mm, 3);
    EXPECT_LE(result.gaps[1].mm, 1.6);  // no more than asked for: 2 % on top
}

TEST(NestSurfaces, KeepsTheSurfaceFixedThatItIsToldTo) {
    NestOptions options = withGap(2);
    const Surfaces spheres{inner(), icosphere(4, {}, 81), icosphere(4, {}, 82)};
    for (std::size_t fixed = 0; fixed < 3; ++fixed) {
        SCOPED_TRACE(fixed);
        options.fixedSurface = fixed;
        const NestResult result = nestSurfaces(spheres, options);
        expectNested(result, 3, 2);
        if (HasFatalFailure()) return;
        EXPECT_EQ(result.surfaces[fixed], spheres[fixed]);
    }
}

TEST(NestSurfaces, NestsAHeadWithEarsAroundASkull) {
    // The skull is the head shrunk and shifted, so that it pokes out at one side and lies near the
    // base of an ear.
    RemeshOptions remesh;
    remesh.vertices = 1281;
    const TriangleMesh skin = remeshForBem(denseSurface(headWithEars(), 120, 1.5), remesh).mesh;
    const TriangleMesh skull =
        remeshForBem(denseSurface(ellipsoid({6, 0, 15}, {68, 88, 78}), 120, 1.5), remesh).mesh;
    NestOptions options = withGap(2);
    const NestResult result = nestSurfaces({skull, skin}, options);
    expectNested(result, 2, 2);
    if (HasFatalFailure()) return;
    EXPECT_LE(result.moves[1].maximumMm, 8);
    // The far ear, nose and neck are where they were.
    for (std::size_t v = 0; v < skin.points.size(); ++v) {
        if (skin.points[v].x < -75 || skin.points[v].z < -90) {
            EXPECT_EQ(result.surfaces[1].points[v], skin.points[v]);
        }
    }
}

TEST(NestSurfaces, NestsRandomStarsInEachOther) {
    // Two shapes of the same mean radius, one 6 mm larger: they cross almost everywhere.
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE(seed);
        RemeshOptions remesh;
        remesh.vertices = 400;
        const TriangleMesh inside =
            remeshForBem(denseSurface(randomStar(seed), 90, 2), remesh).mesh;
        TriangleMesh outside =
            remeshForBem(denseSurface(randomStar(seed + 100), 90, 2), remesh).mesh;
        for (Vec3& p : outside.points) p = 1.1 * p;
        NestOptions options = withGap(2);
        options.maxMoveMm = 40;
        expectNested(nestSurfaces({inside, outside}, options), 2, 2);
    }
}

TEST(NestSurfaces, SwappedSurfacesAreAFinding) {
    // They could be nested by moves of 14 mm, but that is not what was meant.
    const NestResult result = nestSurfaces({icosphere(3, {}, 92), icosphere(3, {}, 80)}, {});
    ASSERT_EQ(result.findings.size(), 1);
    EXPECT_NE(result.findings[0].what.find("they are swapped"), std::string::npos);
    EXPECT_TRUE(result.surfaces.empty());
}

TEST(NestSurfaces, SurfacesApartAreAFinding) {
    const NestResult result = nestSurfaces({inner(), icosphere(4, {300, 0, 0}, 92)}, {});
    ASSERT_EQ(result.findings.size(), 1);
    EXPECT_NE(result.findings[0].what.find("they are apart"), std::string::npos);
    EXPECT_NEAR(norm(result.findings[0].pointMm - Vec3{80, 0, 0}), 0, 10);  // the near side
    EXPECT_TRUE(result.surfaces.empty());
    EXPECT_TRUE(result.gaps.empty());
}

TEST(NestSurfaces, AMoveBeyondTheLimitIsAFindingWithItsPlace) {
    const TriangleMesh bumped = withBump(inner(), {0, 0, 80}, 15, 30);
    NestOptions options = withGap(2);
    options.maxMoveMm = 10;  // 24 + 2 are needed
    const NestResult result = nestSurfaces({bumped, icosphere(4, {}, 86)}, options);
    ASSERT_EQ(result.findings.size(), 1);
    EXPECT_NEAR(norm(result.findings[0].pointMm - Vec3{0, 0, 86}), 0, 15);  // on the bump
}

TEST(NestSurfaces, ASurfaceThatCrossesItselfIsAFinding) {
    // A vertex drawn through the other side of the sphere.
    TriangleMesh crossing = icosphere(3, {}, 86);
    crossing.points[0] = -1.2 * crossing.points[0];
    crossing.normals.clear();
    const NestResult result = nestSurfaces({icosphere(3, {}, 20), crossing}, {});
    ASSERT_EQ(result.findings.size(), 1);
    EXPECT_NE(result.findings[0].what.find("surface 1: "), std::string::npos);
    EXPECT_TRUE(result.surfaces.empty());
}

TEST(NestSurfaces, OneSurfaceIsNested) {
    const NestResult result = nestSurfaces({inner()}, {});
    EXPECT_TRUE(result.findings.empty());
    EXPECT_EQ(result.surfaces, Surfaces{inner()});
    EXPECT_TRUE(result.gaps.empty());
}

TEST(NestSurfaces, GivesTheSameBytesWhateverTheThreads) {
    const Surfaces spheres{inner(), icosphere(4, {3, 0, 0}, 81), icosphere(4, {-2, 3, 0}, 82)};
    const Surfaces many = nestSurfaces(spheres, withGap(2)).surfaces;
    const ThreadLimitGuard one(1);
    EXPECT_EQ(nestSurfaces(spheres, withGap(2)).surfaces, many);
}

TEST(NestSurfaces, RefusesArgumentsThatMakeNoSense) {
    const Surfaces two{icosphere(1, {}, 80), icosphere(1, {}, 86)};
    NestOptions options;
    options.fixedSurface = 2;
    EXPECT_THROW(nestSurfaces(two, options), InvalidInput);
    EXPECT_THROW(nestSurfaces({}, {}), InvalidInput);
    options = {};
    options.minGapsMm = {1, 1};
    EXPECT_THROW(nestSurfaces(two, options), InvalidInput);
    EXPECT_THROW(nestSurfaces(two, withGap(0)), InvalidInput);
    EXPECT_THROW(nestSurfaces(two, withGap(std::nan(""))), InvalidInput);
    options = {};
    options.maxMoveMm = -1;
    EXPECT_THROW(nestSurfaces(two, options), InvalidInput);
    EXPECT_THROW(nestSurfaces({withHole(two[0]), two[1]}, {}), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
