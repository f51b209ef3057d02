#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfaceChecks/Checks.h"
#include "adaptiso/SurfaceChecks/Solids.h"

namespace adaptiso {
namespace {

/// Several solids in one mesh, equal corners joined or not.
struct Parts {
    TriangleMesh mesh;
    std::vector<std::int64_t> firstTriangles;

    Parts& add(const TriangleMesh& part) {
        firstTriangles.push_back(std::ssize(mesh.triangles));
        const auto before = static_cast<VertexId>(mesh.points.size());
        mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
        for (const auto& [a, b, c] : part.triangles) {
            mesh.triangles.push_back({a + before, b + before, c + before});
        }
        return *this;
    }
};

/// The corner of a cube cut off, its right angle at `origin`; mirrored to the other side of x = 0.
TriangleMesh corner(double sideMm, bool isMirrored = false, const Vec3& origin = {}) {
    TriangleMesh mesh;
    mesh.points = {origin, origin + Vec3{isMirrored ? -sideMm : sideMm, 0, 0},
                   origin + Vec3{0, sideMm, 0}, origin + Vec3{0, 0, sideMm}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    if (isMirrored) flipOrientation(mesh);
    return mesh;
}

TriangleMesh flipped(TriangleMesh mesh) {
    flipOrientation(mesh);
    return mesh;
}

std::vector<std::string_view> failedKeys(const SurfaceFacts& facts) {
    std::vector<std::string_view> keys;
    for (const Check& check : judgeSurface(facts, {})) {
        if (check.breaksProfile()) keys.push_back(check.key);
    }
    return keys;
}

SurfaceFacts measured(Parts parts, bool areJoined) {
    if (areJoined) joinVertices(parts.mesh);
    const std::vector<Solid> solids = separateSolids(parts.mesh, parts.firstTriangles);
    EXPECT_EQ(solids.size(), parts.firstTriangles.size());
    return measureSurface(parts.mesh, {}, 10, solids);
}

using Keys = std::vector<std::string_view>;

TEST(Solids, WallsThatTwoShareAreNoFaults) {
    const Parts parts = Parts().add(corner(10)).add(corner(10, true));
    for (const bool areJoined : {false, true}) {
        const SurfaceFacts facts = measured(parts, areJoined);
        EXPECT_EQ(failedKeys(facts), Keys{});
        EXPECT_EQ(facts.solids, 2U);
        EXPECT_EQ(facts.sharedWallTriangles, 1);
        EXPECT_NEAR(*facts.volumeMm3, 2 * 1000.0 / 6, 1e-9);
        EXPECT_EQ(facts.topology.components.size(), 2U);
    }
    // without the solids they are
    EXPECT_EQ(failedKeys(measureSurface(parts.mesh, {}, 10)),
              (Keys{"noDuplicateTriangles", "noSelfIntersections"}));
}

TEST(Solids, ThatFillAnothersCavityFaceOutward) {
    const TriangleMesh ball = testing::icosphere(2, {}, 10);
    Parts shell;
    shell.add(testing::icosphere(2, {}, 20));
    const Parts both = [&] {
        Parts parts = shell;
        parts.add(flipped(ball));  // the wall of the shell's cavity
        parts.firstTriangles.pop_back();
        return parts.add(ball);
    }();
    const SurfaceFacts facts = measured(both, false);
    EXPECT_EQ(failedKeys(facts), Keys{});
    EXPECT_EQ(facts.sharedWallTriangles, std::ssize(ball.triangles));
}

TEST(Solids, InAnothersMaterialAreAFault) {
    const TriangleMesh large = testing::icosphere(2, {}, 20), small = testing::icosphere(2, {}, 5),
                       beside = testing::icosphere(2, {30, 0, 0}, 5);
    const SurfaceFacts overlapping = measured(Parts().add(large).add(small).add(beside), false);
    EXPECT_EQ(failedKeys(overlapping), Keys{"outward"});
    EXPECT_EQ(overlapping.insideOut, std::vector<std::int64_t>{1});
    // the wall of a cavity as a solid of its own
    EXPECT_EQ(failedKeys(measured(Parts().add(large).add(flipped(small)), false)), Keys{});
    // a ball in that cavity, touching nothing; and one in a ball's wall
    Parts hollow = Parts().add(large).add(flipped(testing::icosphere(2, {}, 15)));
    hollow.firstTriangles.pop_back();
    EXPECT_EQ(failedKeys(measured(Parts(hollow).add(small), false)), Keys{});
    const SurfaceFacts inWall =
        measured(Parts(hollow).add(testing::icosphere(2, {17.5, 0, 0}, 1)), false);
    EXPECT_EQ(failedKeys(inWall), Keys{"outward"});
    EXPECT_EQ(inWall.insideOut, std::vector<std::int64_t>{2});
}

TEST(Solids, AreJudgedEach) {
    const SurfaceFacts crossing =
        measured(Parts().add(corner(10)).add(corner(10, false, {1, 1, 1})), false);
    EXPECT_EQ(failedKeys(crossing), Keys{"noSelfIntersections"});

    // given twice, not side by side
    const SurfaceFacts twice = measured(Parts().add(corner(10)).add(corner(10)), true);
    EXPECT_EQ(failedKeys(twice), Keys{"noSelfIntersections"});
    EXPECT_EQ(twice.sharedWallTriangles, 0);
    EXPECT_EQ(twice.intersections.pairCount, 4);
    EXPECT_EQ(twice.intersections.pairs.front(), (TrianglePair{0, 4}));

    const SurfaceFacts insideOut =
        measured(Parts().add(corner(10)).add(flipped(corner(5, false, {20, 0, 0}))), false);
    EXPECT_EQ(failedKeys(insideOut), Keys{"outward"});
    EXPECT_EQ(insideOut.insideOut, std::vector<std::int64_t>{1});

    Parts parts = Parts().add(corner(10, true)).add(corner(10)).add(corner(10, false, {20, 0, 0}));
    parts.mesh.triangles.push_back(parts.mesh.triangles.back());
    parts.mesh.triangles.back()[0] = parts.mesh.triangles.back()[1];
    const SurfaceFacts degenerate = measured(parts, false);
    EXPECT_EQ(failedKeys(degenerate), Keys{"noDegenerateTriangles"});
    EXPECT_EQ(degenerate.sharedWallTriangles, 1);

    // a triangle of one vertex, which no other uses, is of no piece
    parts = Parts().add(corner(10)).add(corner(10, true));
    parts.mesh.points.push_back({99, 99, 99});
    parts.mesh.triangles.push_back({8, 8, 8});
    EXPECT_EQ(failedKeys(measured(parts, false)), Keys{"noDegenerateTriangles"});
    TriangleMesh nan = parts.mesh;
    nan.points[1].x = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Solid> solids = separateSolids(nan, parts.firstTriangles);
    EXPECT_EQ(failedKeys(measureSurface(nan, {}, 10, solids)),
              (Keys{"finiteCoordinates", "noDegenerateTriangles"}));
}

TEST(Solids, PatchesOfOneSurfaceStayJoined) {
    TriangleMesh mesh = corner(10);
    const TriangleMesh given = mesh;
    EXPECT_TRUE(separateSolids(mesh, std::vector<std::int64_t>{0, 2}).empty());
    EXPECT_TRUE(separateSolids(mesh, std::vector<std::int64_t>{0}).empty());
    EXPECT_TRUE(separateSolids(mesh, std::vector<std::int64_t>{0, 4}).empty()) << "one is empty";
    EXPECT_TRUE(separateSolids(mesh, {}).empty());
    // numbers that no reader gives
    Parts parts = Parts().add(corner(10)).add(corner(10, true)).add(corner(10, true, {-9, 0, 0}));
    for (const std::vector<std::int64_t>& wrong :
         {std::vector<std::int64_t>{4, 8}, {0, 8, 4}, {0, 4, 99}}) {
        EXPECT_TRUE(separateSolids(parts.mesh, wrong).empty());
    }
    EXPECT_EQ(mesh, given);
}

TEST(Solids, KeepTheirTrianglesNumbersAndUnusedVertices) {
    Parts parts = Parts().add(corner(10)).add(corner(10, true));
    joinVertices(parts.mesh);
    parts.mesh.points.push_back({7, 7, 7});
    const TriangleMesh given = parts.mesh;
    const std::vector<Solid> solids = separateSolids(parts.mesh, parts.firstTriangles);
    ASSERT_EQ(solids.size(), 2U);
    ASSERT_EQ(parts.mesh.triangles.size(), given.triangles.size());
    for (std::int64_t t = 0; t < std::ssize(given.triangles); ++t) {
        EXPECT_EQ(cornersOf(parts.mesh, t), cornersOf(given, t)) << t;
    }
    // the joined mesh has left three unused, as joinVertices() does, and one was added
    EXPECT_EQ(checkTopology(parts.mesh).count(TopologyDefect::UnusedVertex), 4);
    EXPECT_EQ(solidAt(parts.mesh, solids, 0).points.size(), 4U);
    EXPECT_EQ(solidAt(parts.mesh, solids, 1).triangles.size(), 4U);
}

TEST(Solids, WallsAreMeasuredInEach) {
    const Parts parts =
        Parts().add(corner(10)).add(corner(10, true)).add(testing::icosphere(2, {30, 0, 0}, 2));
    TriangleMesh mesh = parts.mesh;
    const std::vector<Solid> solids = separateSolids(mesh, parts.firstTriangles);
    SurfaceFacts facts = measureSurface(mesh, {}, 10, solids), alone = facts;
    measureWallsOf(mesh, 1, facts, solids);
    measureWallsOf(solidAt(mesh, solids, 2), 1, alone);
    ASSERT_TRUE(facts.walls && alone.walls);
    ASSERT_TRUE(facts.walls->hasWall());
    EXPECT_DOUBLE_EQ(facts.walls->leastMm, alone.walls->leastMm);
    EXPECT_EQ(facts.walls->triangle, alone.walls->triangle + 8);
    EXPECT_NEAR(facts.walls->areaMm2, surfaceArea(mesh), 1e-9);
}

}  // namespace
}  // namespace adaptiso
