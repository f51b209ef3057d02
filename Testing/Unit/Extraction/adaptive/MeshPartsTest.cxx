// How a mesh is made ready to be simplified: MeshParts, FlatTriangles, MeshSurface, and the proof
// of its distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/Extraction/detail/FlatTriangles.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptive/full/MeshSurface.h"
#include "adaptive/proof/DistanceProof.h"
#include "adaptive/rounds/BorderMarks.h"
#include "repair/MeshParts.h"

namespace adaptiso::testing {
namespace {

using detail::MeshParts;
using detail::Patch;
using detail::SimplifiedSurface;
using detail::takeApart;

TriangleMesh bare(TriangleMesh mesh) {
    mesh.normals = {};
    return mesh;
}

/// The surface of a mesh with nothing changed of it.
SimplifiedSurface whole(const detail::MeshSurface& surface) {
    return surface.firstRound({}, nullptr);  // a collapse costs more than nothing
}

}  // namespace

TEST(MeshParts, LeavesASoundMeshAsItIs) {
    const TriangleMesh sphere = icosphere(3, {1, 2, 3}, 5);
    const MeshParts parts = takeApart(sphere, false);
    ASSERT_EQ(parts.points.size(), sphere.points.size());
    for (std::size_t v = 0; v < parts.points.size(); ++v) {
        EXPECT_EQ(parts.points[v] + parts.origin, sphere.points[v]);
    }
    EXPECT_EQ(parts.triangles.size(), sphere.triangles.size());
    EXPECT_TRUE(parts.marks.empty() && parts.isKept.empty() && parts.borderEdges.empty());
    EXPECT_TRUE(parts.nonManifold.empty() && parts.crossing.isEmpty());
}

TEST(MeshParts, MovesFarMeshesWithoutLosingABit) {
    for (const double far : {7.3, 1e3, 1e7, -1e5}) {
        const TriangleMesh sphere = icosphere(3, {far, 0.1 * far, -far}, 5);
        const MeshParts parts = takeApart(sphere, false);
        for (std::size_t v = 0; v < parts.points.size(); ++v) {
            ASSERT_EQ(parts.points[v] + parts.origin, sphere.points[v]) << far;
        }
    }
    EXPECT_LT(norm(takeApart(icosphere(2, {1e7, 1e7, 1e7}, 5), false).points[0]), 10);
}

TEST(MeshParts, CutsAVertexOfTwoFansApart) {
    const TriangleMesh touching = twoSpheresTouchingAtAVertex();
    const MeshParts parts = takeApart(touching, false);
    EXPECT_EQ(parts.points.size(), touching.points.size() + 1);
    ASSERT_EQ(parts.nonManifold.size(), 1U);
    EXPECT_EQ(std::count(parts.marks.begin(), parts.marks.end(), Patch::kBorder + 1), 2);
    EXPECT_EQ(std::count(parts.isKept.begin(), parts.isKept.end(), 1), 2);
    EXPECT_TRUE(parts.borderEdges.empty());
}

TEST(MeshParts, CutsAnEdgeOfThreeTrianglesApart) {
    const MeshParts parts = takeApart(threeTrianglesOnAnEdge(), false);
    EXPECT_EQ(parts.nonManifold.size(), 2U);
    EXPECT_EQ(parts.points.size(), 9U);       // three triangles by themselves
    EXPECT_EQ(parts.borderEdges.size(), 6U);  // the cut is none
}

TEST(MeshParts, KeepsWhatCrosses) {
    const TriangleMesh spheres = bare(crossingSpheres(3));
    const MeshParts parts = takeApart(spheres, false);
    ASSERT_FALSE(parts.crossing.found.empty());
    EXPECT_TRUE(parts.crossing.isComplete());
    for (const std::int64_t t : parts.crossing.found) {
        for (const std::uint32_t v : parts.triangles[t]) EXPECT_EQ(parts.isKept[v], 1);
    }
}

TEST(FlatTriangles, SplitTheirNeighbours) {
    const TriangleMesh flat = withZeroAreaTriangle(icosphere(2));
    const detail::AreaTriangles result = detail::withoutFlatTriangles(flat, 0);
    EXPECT_EQ(result.flat, 1);
    EXPECT_EQ(std::count(result.isLeftOut.begin(), result.isLeftOut.end(), 1), 0);
    TriangleMesh mended = bare(flat);
    mended.triangles = result.triangles;
    expectSound(mended);
}

// A triangle without area on an edge that has its two triangles already: split there, one of these
// would leave the other with an edge of its own, a slit in what was closed.
TEST(FlatTriangles, AreLeftOutWhereTheirSideHasTwoOthers) {
    const TriangleMesh sphere = bare(icosphere(2));
    const Triangle& t = sphere.triangles[0];
    for (const auto& [a, b] : {std::pair(t[0], t[1]), std::pair(t[1], t[0])}) {
        TriangleMesh flat = sphere;
        flat.points.push_back(0.5 * (flat.points[a] + flat.points[b]));
        flat.triangles.push_back({a, b, std::ssize(flat.points) - 1});
        ASSERT_TRUE(isDegenerate(flat, flat.triangles.back()));
        const detail::AreaTriangles result = detail::withoutFlatTriangles(flat, 0);
        EXPECT_EQ(result.flat, 1);
        ASSERT_EQ(result.triangles.size(), flat.triangles.size());
        EXPECT_EQ(std::count(result.isLeftOut.begin(), result.isLeftOut.end(), 1), 1);
        EXPECT_EQ(result.isLeftOut.back(), 1);
        EXPECT_TRUE(
            std::equal(sphere.triangles.begin(), sphere.triangles.end(), result.triangles.begin()));
    }
}

TEST(FlatTriangles, JoinVerticesAtOnePlace) {
    // an edge of a sphere opened to two vertices at one place, with two triangles without area
    TriangleMesh sphere = bare(icosphere(2));
    const Triangle first = sphere.triangles[0];
    const auto copy = std::ssize(sphere.points);
    sphere.points.push_back(sphere.points[first[0]]);
    sphere.triangles[0] = {copy, first[1], first[2]};
    sphere.triangles.push_back({first[0], first[1], copy});
    sphere.triangles.push_back({first[0], copy, first[2]});
    const detail::AreaTriangles result = detail::withoutFlatTriangles(sphere, 0);
    EXPECT_EQ(result.flat, 2);
    EXPECT_EQ(std::count(result.isLeftOut.begin(), result.isLeftOut.end(), 1), 2);
    EXPECT_EQ(result.triangles[0], first);
}

/// A sphere with a vertex in two parts next to each other, closed by two needles.
TriangleMesh withNeedles(double gapMm) {
    TriangleMesh sphere = bare(icosphere(2));
    const auto [a, b, c] = sphere.triangles[0];
    const auto copy = std::ssize(sphere.points);
    sphere.points.push_back(sphere.points[a] + gapMm * (sphere.points[b] - sphere.points[a]));
    sphere.triangles[0] = {copy, b, c};
    sphere.triangles.push_back({a, b, copy});
    sphere.triangles.push_back({a, copy, c});
    return sphere;
}

// left out, they were slits in a surface that was closed
TEST(FlatTriangles, ThatAreNeedlesLoseTheirShortestEdge) {
    const TriangleMesh sphere = withNeedles(1e-11);
    const detail::AreaTriangles result = detail::withoutFlatTriangles(sphere, 1e-10);
    EXPECT_EQ(result.flat, 2);
    EXPECT_EQ(std::count(result.isLeftOut.begin(), result.isLeftOut.end(), 1), 2);
    EXPECT_EQ(result.triangles[0], icosphere(2).triangles[0]);
    EXPECT_GT(result.movedMm, 1e-12);
    EXPECT_LE(result.movedMm, 1e-11);
    EXPECT_EQ(detail::withoutFlatTriangles(sphere, 1e-12).movedMm, 0);
}

TEST(FlatTriangles, ThatAreNeedlesStayAtEdgesOfThreeTriangles) {
    TriangleMesh sphere = withNeedles(1e-11);
    const auto [a, b, c] = sphere.triangles[0];
    sphere.points.push_back({0, 0, 9});
    sphere.triangles.push_back({a, b, std::ssize(sphere.points) - 1});
    EXPECT_EQ(detail::withoutFlatTriangles(sphere, 1e-10).movedMm, 0);
}

TEST(BorderMarks, FindAndWeighTheBorder) {
    const TriangleMesh plane = bare(planeMesh(4, 4));
    const MeshParts parts = takeApart(plane, false);
    EXPECT_EQ(parts.borderEdges.size(), 16U);
    const SimplifiedSurface surface = whole(detail::MeshSurface(plane, parts, {}));
    std::vector<std::uint8_t> candidates(surface.points.size(), 1);
    EXPECT_EQ(detail::openHalfEdges(surface, candidates), parts.borderEdges);
    for (std::size_t v = 0; v < candidates.size(); ++v) {
        candidates[v] = static_cast<std::uint8_t>(surface.marks[v] == Patch::kBorder);
    }
    EXPECT_EQ(detail::openHalfEdges(surface, candidates), parts.borderEdges);
    EXPECT_EQ(std::count(surface.marks.begin(), surface.marks.end(), Patch::kBorder), 16);
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        EXPECT_EQ(surface.samples[v].isOnBorder, surface.marks[v] == Patch::kBorder);
        // a step outwards costs at a border, and nothing elsewhere: the plane is flat
        const detail::Quadric q = surface.quadrics[v].about(surface.points[v]);
        const double cost = q.at(surface.points[v] + Vec3{0.5, 0.5, 0});
        EXPECT_EQ(cost > 1e-6, surface.marks[v] == Patch::kBorder);
    }
}

TEST(MeshSurface, GivesTheMeshBack) {
    for (const TriangleMesh& mesh :
         {bare(icosphere(3, {500, 0, 0}, 5)), bare(twoSpheresTouchingAtAVertex()),
          threeTrianglesOnAnEdge()}) {
        const MeshParts parts = takeApart(mesh, false);
        const detail::MeshSurface full(mesh, parts, {});
        const TriangleMesh back = full.meshOf(whole(full));
        EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
        EXPECT_EQ(back.points.size(), mesh.points.size());
        const auto count = [](const TriangleMesh& m, TopologyDefect defect) {
            return checkTopology(m).count(defect);
        };
        for (const TopologyDefect defect :
             {TopologyDefect::NonManifoldEdge, TopologyDefect::NonManifoldVertex,
              TopologyDefect::BoundaryEdge}) {
            EXPECT_EQ(count(back, defect), count(mesh, defect));
        }
    }
}

TEST(DistanceProof, SaysThatAMeshIsNearItself) {
    const TriangleMesh sphere = bare(icosphere(4, {}, 10));
    const MeshParts parts = takeApart(sphere, false);
    const detail::MeshSurface full(sphere, parts, {});
    const detail::ErrorBound bound =
        detail::DistanceProof(parts.view(), full.frame(), 0.1).prove(whole(full));
    EXPECT_TRUE(bound.beyondLimit.empty());
    EXPECT_LT(bound.largestMm, 0.02);  // a hundredth of a voxel is not told from nothing
}

TEST(DistanceProof, BoundsAMeshMovedOutward) {
    const TriangleMesh sphere = bare(icosphere(4, {}, 10));
    const MeshParts parts = takeApart(sphere, false);
    const detail::MeshSurface full(sphere, parts, {});
    SimplifiedSurface moved = whole(full);
    for (Vec3& p : moved.points) p = 1.02 * p;
    const detail::ErrorBound bound =
        detail::DistanceProof(parts.view(), full.frame(), std::numeric_limits<double>::max())
            .prove(moved);
    EXPECT_GE(bound.largestMm, 0.198);  // at vertices 0.2, a little less over triangles
    EXPECT_LE(bound.largestMm, 0.206);
}

TEST(DistanceProof, FindsAVertexThatWasPulledOutAndForgetsItWhenItIsBack) {
    const TriangleMesh sphere = bare(icosphere(4, {}, 10));
    const MeshParts parts = takeApart(sphere, false);
    const detail::MeshSurface full(sphere, parts, {});
    detail::DistanceProof proof(parts.view(), full.frame(), 0.1);
    SimplifiedSurface surface = whole(full);
    const Vec3 before = surface.points[7];
    surface.points[7] = 1.1 * before;
    const detail::ErrorBound pulled = proof.prove(surface);
    EXPECT_GT(pulled.largestMm, 0.9);
    ASSERT_FALSE(pulled.beyondLimit.empty());
    for (const detail::PlaceBeyond& place : pulled.beyondLimit) {
        EXPECT_LT(norm(place.point() - before), 2);
    }
    EXPECT_TRUE(proof.proveAgain(surface, moveVertex(surface, 7, before)).beyondLimit.empty());
}

// Nothing is beyond no limit; the bound is what was proved of all that is still there.
TEST(DistanceProof, BoundsAMeshAgainWithoutALimit) {
    const TriangleMesh sphere = bare(icosphere(4, {}, 10));
    const MeshParts parts = takeApart(sphere, false);
    const detail::MeshSurface full(sphere, parts, {});
    constexpr double kNoLimit = std::numeric_limits<double>::max();
    detail::DistanceProof proof(parts.view(), full.frame(), kNoLimit);
    SimplifiedSurface surface = whole(full);
    double largestMm = proof.prove(surface).largestMm;
    EXPECT_LT(largestMm, 0.05);
    for (const double mm : {0.2, 0.6, 1.5}) {
        const auto vertex = static_cast<std::uint32_t>(100 * mm);
        const Vec3 moved = (1 + mm / 10) * surface.points[vertex];
        const detail::ErrorBound again =
            proof.proveAgain(surface, moveVertex(surface, vertex, moved));
        const detail::ErrorBound anew =
            detail::DistanceProof(parts.view(), full.frame(), kNoLimit).prove(surface);
        EXPECT_GT(anew.largestMm, 0.5 * mm);
        EXPECT_NEAR(again.largestMm, std::max(anew.largestMm, largestMm), 0.05);
        EXPECT_TRUE(again.beyondLimit.empty());
        largestMm = again.largestMm;
    }
}

TEST(DistanceProof, FindsAPieceThatTheSimplifiedMeshLacks) {
    const TriangleMesh both = bare(merged({icosphere(3, {}, 10), icosphere(2, {30, 0, 0}, 2)}));
    const MeshParts parts = takeApart(both, false);
    const detail::MeshSurface full(both, parts, {});
    SimplifiedSurface surface = whole(full);
    const std::size_t kept = icosphere(3).triangles.size();
    surface.triangles.resize(kept);
    for (std::uint32_t& t : surface.sampleTriangle) {
        t = std::min(t, static_cast<std::uint32_t>(kept - 1));
    }
    const detail::ErrorBound bound =
        detail::DistanceProof(parts.view(), full.frame(), 1).prove(surface);
    EXPECT_NEAR(bound.largestMm, 22, 0.5);  // from the far side of the small sphere
    EXPECT_TRUE(std::any_of(bound.beyondLimit.begin(), bound.beyondLimit.end(),
                            [](const detail::PlaceBeyond& p) { return p.isOfFine; }));
}

}  // namespace adaptiso::testing
