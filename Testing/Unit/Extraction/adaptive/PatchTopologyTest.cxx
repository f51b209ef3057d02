#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;
using detail::PatchTopology;
using detail::Star;

/// A ring of n vertices, and two poles that each join all of it.
TriangleMesh doublePyramid(VertexId n) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 1}, {0, 0, -1}};
    for (VertexId i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(n);
        mesh.points.push_back({std::cos(angle), std::sin(angle), 0});
        const VertexId here = 2 + i, next = 2 + (i + 1) % n;
        mesh.triangles.push_back({0, here, next});
        mesh.triangles.push_back({1, next, here});
    }
    return mesh;
}

/// The half-edge from one vertex to another.
std::uint32_t halfEdge(const Patch& patch, const PatchTopology& topology, std::uint32_t from,
                       std::uint32_t to) {
    for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
        if (patch.triangles[h / 3][0] == Patch::kGone) continue;
        if (topology.from(h) == from && topology.to(h) == to) return h;
    }
    return PatchTopology::kNone;
}

}  // namespace

TEST(PatchTopology, MovesNoVertexOfABorderOrOfAnObstacle) {
    Patch plane = patchOf(planeMesh(4, 4));
    const PatchTopology open(plane);
    for (std::uint32_t v = 0; v < plane.points.size(); ++v) {
        const Vec3& p = plane.points[v];
        EXPECT_EQ(open.isMovable(v), p.x > 0 && p.x < 4 && p.y > 0 && p.y < 4);
    }
    Patch sphere = patchOf(icosphere(1), 1);
    const PatchTopology closed(sphere);
    for (std::uint32_t v = 0; v < sphere.points.size(); ++v) {
        const auto& obstacle = sphere.triangles.back();
        const bool isAtObstacle = std::find(obstacle.begin(), obstacle.end(), v) != obstacle.end();
        EXPECT_EQ(closed.isMovable(v), !isAtObstacle);
    }
}

TEST(PatchTopology, MovesNoVertexWithAFanOfObstaclesBesideItsOwn) {
    const TriangleMesh mesh = twoSpheresTouchingAtAVertex();
    Patch patch = patchOf(mesh, mesh.triangles.size() / 2);
    const PatchTopology topology(patch);
    int fixed = 0;
    for (std::uint32_t t = 0; t < patch.ownTriangles; ++t) {
        for (const std::uint32_t v : patch.triangles[t]) fixed += topology.isMovable(v) ? 0 : 1;
    }
    EXPECT_GT(fixed, 2);
    EXPECT_LT(fixed, 7);  // one vertex, in each of its triangles
}

TEST(PatchTopology, GivesTheClosedRingAroundAVertex) {
    Patch patch = patchOf(icosphere(0));
    const PatchTopology topology(patch);
    for (std::uint32_t v = 0; v < 12; ++v) {
        Star star;
        ASSERT_TRUE(topology.starOf(v, star));
        ASSERT_EQ(star.count, 5);
        for (int i = 0; i < 5; ++i) {
            EXPECT_EQ(star.apex[i], v);
            auto t = patch.triangles[star.triangle[i]];
            std::rotate(t.begin(), std::find(t.begin(), t.end(), v), t.end());
            EXPECT_EQ(t, (std::array{v, star.ring[i], star.ring[(i + 1) % 5]}));
        }
    }
}

TEST(PatchTopology, SaysWhereAStarIsTooLarge) {
    for (const int count : {Star::kMost, Star::kMost + 1}) {
        Patch patch = patchOf(doublePyramid(count));
        Star star;
        EXPECT_EQ(PatchTopology(patch).starOf(0, star), count <= Star::kMost);
    }
}

TEST(PatchTopology, RefusesEveryEdgeOfATetrahedron) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    Patch patch = patchOf(mesh);
    PatchTopology topology(patch);
    for (std::uint32_t h = 0; h < 12; ++h) {
        Star star;
        EXPECT_FALSE(topology.starOfEdge(h, star)) << h;
    }
}

// The ends of an edge of the equator have both poles in common, and the third vertex of the equator
// too: merging them would leave two triangles with the same three vertices, back to back.
TEST(PatchTopology, RefusesAnEdgeWhoseEndsShareAThirdNeighbour) {
    Patch patch = patchOf(doublePyramid(3));
    PatchTopology topology(patch);
    Star star;
    EXPECT_FALSE(topology.starOfEdge(halfEdge(patch, topology, 2, 3), star));
    EXPECT_TRUE(topology.starOfEdge(halfEdge(patch, topology, 0, 2), star));
}

// An edge of the narrowest ring of a tube: merging its ends would leave a bowtie, two edges between
// the same two vertices.
TEST(PatchTopology, RefusesAnEdgeOfANeckOfThree) {
    const TriangleMesh torus = torusMesh(6, 3, 3, 1);
    Patch patch = patchOf(torus);
    PatchTopology topology(patch);
    int refused = 0;
    for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
        // the three vertices of a neck have the same direction from the axis
        const Vec3 &p = patch.points[topology.from(h)], &q = patch.points[topology.to(h)];
        if (std::abs(p.x * q.y - p.y * q.x) > 1e-9) continue;
        Star star;
        EXPECT_FALSE(topology.starOfEdge(h, star)) << h;
        ++refused;
    }
    EXPECT_EQ(refused, 6 * 3 * 2);
}

}  // namespace adaptiso::testing
