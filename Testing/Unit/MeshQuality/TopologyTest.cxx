#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

using enum TopologyDefect;
using testing::cubeMesh;
using testing::icosphere;
using testing::isSound;
using testing::torusMesh;

/// How many defects `mesh` has besides those of `defect`.
std::int64_t countOthers(const TopologyReport& report, TopologyDefect defect) {
    std::int64_t sum = 0;
    for (const std::int64_t n : report.defects) sum += n;
    return sum - report.count(defect);
}

TEST(Topology, CubeHasTheCountsOfEuler) {
    const TopologyReport report = checkTopology(cubeMesh());
    EXPECT_TRUE(report.isSound());
    EXPECT_TRUE(report.isWatertight());
    ASSERT_EQ(report.components.size(), 1u);
    const SurfaceComponent& cube = report.components.front();
    EXPECT_EQ(cube.vertices, 8);
    EXPECT_EQ(cube.edges, 18);
    EXPECT_EQ(cube.triangles, 12);
    EXPECT_EQ(report.edges, 18);
    EXPECT_EQ(cube.eulerCharacteristic(), 2);
    EXPECT_EQ(cube.genus(), 0);
    EXPECT_DOUBLE_EQ(cube.areaMm2, 6);
    EXPECT_DOUBLE_EQ(cube.signedVolumeMm3, 1);
    EXPECT_TRUE(cube.isOutward());
    EXPECT_TRUE(report.examples.empty());
}

TEST(Topology, TorusHasGenusOne) {
    const TopologyReport report = checkTopology(torusMesh(40, 20, 10, 3));
    EXPECT_TRUE(report.isSound());
    EXPECT_EQ(report.genus(), 1);
    EXPECT_EQ(report.components.front().eulerCharacteristic(), 0);
}

TEST(Topology, SpheresAreSeparateComponentsInVertexOrder) {
    TriangleMesh inner = icosphere(3, {}, 1);
    flipOrientation(inner);
    const TopologyReport report = checkTopology(testing::merged({icosphere(3, {}, 2), inner}));
    EXPECT_TRUE(report.isSound());
    ASSERT_EQ(report.components.size(), 2u);
    EXPECT_EQ(report.genus(), 0);
    EXPECT_EQ(report.components[0].firstVertex, 0);
    EXPECT_EQ(report.components[1].firstVertex, 642);  // 10 * 4^3 + 2 points before it
    EXPECT_TRUE(report.components[0].isOutward());
    EXPECT_FALSE(report.components[1].isOutward());  // the wall of a cavity
    // An icosphere of 1280 triangles encloses 1.3 % less than its sphere (chord error ~ h^2 / 8).
    EXPECT_NEAR(report.components[0].signedVolumeMm3, 8 * 4 * std::numbers::pi / 3, 0.5);
    EXPECT_NEAR(report.components[0].signedVolumeMm3 / report.components[1].signedVolumeMm3, -8,
                1e-9);  // the same polyhedron at twice the size; rounding alone
}

TEST(Topology, EmptyMeshIsSound) {
    const TopologyReport report = checkTopology({});
    EXPECT_TRUE(report.isSound());
    EXPECT_TRUE(report.components.empty());
    EXPECT_EQ(report.genus(), 0);
}

TEST(Topology, HoleHasThreeBoundaryEdges) {
    const TopologyReport report = checkTopology(testing::withHole(icosphere(2)));
    EXPECT_EQ(report.count(BoundaryEdge), 3);
    EXPECT_EQ(countOthers(report, BoundaryEdge), 0);
    EXPECT_FALSE(report.isClosed());
    EXPECT_TRUE(report.isManifold());
    EXPECT_EQ(report.genus(), std::nullopt);
    EXPECT_EQ(report.examples.size(), 3u);
}

TEST(Topology, FlippedTriangleHasThreeInconsistentEdges) {
    const TopologyReport report = checkTopology(testing::withFlippedTriangle(icosphere(2)));
    EXPECT_EQ(report.count(InconsistentEdge), 3);
    EXPECT_EQ(countOthers(report, InconsistentEdge), 0);
    EXPECT_FALSE(report.isOriented());
    EXPECT_FALSE(report.isWatertight());
}

TEST(Topology, DuplicateTriangleIsFoundWhicheverWayRound) {
    for (const bool isFlipped : {false, true}) {
        TriangleMesh mesh = testing::withDuplicateTriangle(icosphere(2));
        if (isFlipped) std::swap(mesh.triangles.back()[0], mesh.triangles.back()[1]);
        const TopologyReport report = checkTopology(mesh);
        EXPECT_EQ(report.count(DuplicateTriangle), 1);
        EXPECT_EQ(report.count(NonManifoldEdge), 3);
        EXPECT_EQ(report.count(NonManifoldVertex), 3);
        EXPECT_EQ(report.examples.size(), 7u);
        const auto duplicate =
            std::find_if(report.examples.begin(), report.examples.end(),
                         [](const auto& e) { return e.defect == DuplicateTriangle; });
        ASSERT_NE(duplicate, report.examples.end());
        EXPECT_EQ(duplicate->triangle, static_cast<std::int64_t>(mesh.triangles.size()) - 1);
    }
}

TEST(Topology, TriangleWithoutAreaIsDegenerateAndOtherwiseFine) {
    const TopologyReport report = checkTopology(testing::withZeroAreaTriangle(cubeMesh()));
    EXPECT_EQ(report.count(DegenerateTriangle), 1);
    EXPECT_EQ(countOthers(report, DegenerateTriangle), 0);
    EXPECT_TRUE(report.isWatertight());
    EXPECT_FALSE(report.isSound());
}

TEST(Topology, TriangleWithARepeatedIndexIsDegenerateAndHasNoEdges) {
    const TopologyReport report = checkTopology(testing::withRepeatedIndex(cubeMesh()));
    EXPECT_EQ(report.count(DegenerateTriangle), 1);
    EXPECT_EQ(countOthers(report, DegenerateTriangle), 0);
    EXPECT_EQ(report.edges, 18);
}

TEST(Topology, DegenerateMeansAnAltitudeBelowABillionthOfTheLongestEdge) {
    TriangleMesh mesh;
    mesh.triangles = {{0, 1, 2}};
    for (const double scale : {1e-3, 1.0, 1e6}) {  // mesh in metres, millimetres, nanometres
        mesh.points = {{0, 0, 0}, {scale, 0, 0}, {0.3 * scale, 2e-9 * scale, 0}};
        EXPECT_EQ(checkTopology(mesh).count(DegenerateTriangle), 0) << scale;
        mesh.points[2].y = 0.5e-9 * scale;
        EXPECT_EQ(checkTopology(mesh).count(DegenerateTriangle), 1) << scale;
    }
}

TEST(Topology, UnusedVertexIsFoundAndIsNoComponent) {
    const TopologyReport report = checkTopology(testing::withUnusedVertex(cubeMesh()));
    EXPECT_EQ(report.count(UnusedVertex), 1);
    EXPECT_EQ(countOthers(report, UnusedVertex), 0);
    EXPECT_EQ(report.components.size(), 1u);
    ASSERT_EQ(report.examples.size(), 1u);
    EXPECT_EQ(report.examples.front().vertices[0], 8);
    EXPECT_EQ(report.examples.front().pointMm, (Vec3{7, 7, 7}));
}

TEST(Topology, VertexThatOnlyABrokenTriangleNamesIsNotUnused) {
    TriangleMesh mesh = testing::withUnusedVertex(cubeMesh());
    mesh.triangles.push_back({8, 8, 0});
    const TopologyReport report = checkTopology(mesh);
    EXPECT_EQ(report.count(UnusedVertex), 0);
    EXPECT_EQ(report.count(DegenerateTriangle), 1);
}

TEST(Topology, NanCoordinateIsFoundAndSpoilsNoSum) {
    const TopologyReport report = checkTopology(testing::withNanCoordinate(cubeMesh()));
    EXPECT_EQ(report.count(NonFiniteVertex), 1);
    EXPECT_EQ(countOthers(report, NonFiniteVertex), 0);
    EXPECT_TRUE(std::isfinite(report.components.front().areaMm2));
    EXPECT_TRUE(std::isfinite(report.components.front().signedVolumeMm3));
}

TEST(Topology, IndexOutOfRangeIsFoundAndLeftAside) {
    const TopologyReport report = checkTopology(testing::withIndexOutOfRange(cubeMesh()));
    EXPECT_EQ(report.count(IndexOutOfRange), 1);
    EXPECT_EQ(countOthers(report, IndexOutOfRange), 0);
    EXPECT_FALSE(report.isWatertight());
    TriangleMesh negative = cubeMesh();
    negative.triangles.push_back({-1, 0, 1});
    EXPECT_EQ(checkTopology(negative).count(IndexOutOfRange), 1);
}

TEST(Topology, SpheresTouchingAtAVertexAreNotManifoldThere) {
    const TopologyReport report = checkTopology(testing::twoSpheresTouchingAtAVertex());
    EXPECT_EQ(report.count(NonManifoldVertex), 1);
    EXPECT_EQ(countOthers(report, NonManifoldVertex), 0);
    EXPECT_TRUE(report.isClosed());
    EXPECT_FALSE(report.isManifold());
    EXPECT_EQ(report.components.size(), 1u);
    EXPECT_EQ(report.genus(), std::nullopt);
}

TEST(Topology, ThreeTrianglesOnAnEdgeAreNotManifold) {
    const TopologyReport report = checkTopology(testing::threeTrianglesOnAnEdge());
    EXPECT_EQ(report.count(NonManifoldEdge), 1);
    EXPECT_EQ(report.count(NonManifoldVertex), 2);
    EXPECT_EQ(report.count(BoundaryEdge), 6);
}

TEST(Topology, ExamplesStopAtTheirLimit) {
    TriangleMesh mesh = icosphere(2);
    mesh.triangles.resize(100);
    const TopologyReport report = checkTopology(mesh, {.maxExamplesPerDefect = 2});
    EXPECT_GT(report.count(BoundaryEdge), 2);
    EXPECT_EQ(std::count_if(report.examples.begin(), report.examples.end(),
                            [](const auto& e) { return e.defect == BoundaryEdge; }),
              2);
}

TEST(Topology, CrossingSpheresAreTopologicallySound) {
    EXPECT_TRUE(checkTopology(testing::crossingSpheres(2)).isSound());
}

TEST(Topology, AgreesWithTheIndependentSoundnessCheck) {
    const TriangleMesh sphere = icosphere(1);
    for (const TriangleMesh& mesh :
         {sphere, cubeMesh(), torusMesh(5, 4, 3, 1), testing::planeMesh(3, 1),
          testing::withHole(sphere), testing::withFlippedTriangle(sphere),
          testing::withDuplicateTriangle(sphere), testing::withZeroAreaTriangle(sphere),
          testing::withRepeatedIndex(sphere), testing::withUnusedVertex(sphere),
          testing::withNanCoordinate(sphere), testing::withIndexOutOfRange(sphere),
          testing::twoSpheresTouchingAtAVertex(), testing::threeTrianglesOnAnEdge(),
          testing::crossingSpheres(1)}) {
        EXPECT_EQ(checkTopology(mesh).isSound(), static_cast<bool>(isSound(mesh)))
            << isSound(mesh).message();
    }
}

TEST(Topology, IsTheSameWhateverTheNumberOfThreads) {
    TriangleMesh mesh = icosphere(6);  // 40962 vertices: several pieces of work
    mesh.triangles.erase(mesh.triangles.begin() + 1000, mesh.triangles.begin() + 2000);
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        return checkTopology(mesh);
    };
    const TopologyReport one = run(1), two = run(2);
    EXPECT_EQ(one.defects, two.defects);
    ASSERT_EQ(one.components.size(), two.components.size());
    EXPECT_EQ(one.components.front().areaMm2, two.components.front().areaMm2);
    ASSERT_EQ(one.examples.size(), two.examples.size());
    for (std::size_t n = 0; n < one.examples.size(); ++n) {
        EXPECT_EQ(one.examples[n].vertices, two.examples[n].vertices);
    }
}

}  // namespace
}  // namespace adaptiso
