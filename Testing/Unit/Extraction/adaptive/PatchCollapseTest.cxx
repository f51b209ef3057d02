#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <vector>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;
using detail::PatchTopology;
using detail::Star;

/// Every half-edge's twin runs the other way and has it as its twin, and each movable vertex knows
/// a half-edge that starts there.
void expectConsistent(const Patch& patch, const PatchTopology& topology) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> halfEdges;
    for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
        if (patch.triangles[h / 3][0] == Patch::kGone) continue;
        EXPECT_TRUE(halfEdges.insert({{topology.from(h), topology.to(h)}, h}).second);
    }
    for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
        if (patch.triangles[h / 3][0] == Patch::kGone) continue;
        const std::uint32_t twin = topology.twin(h);
        const auto other = halfEdges.find({topology.to(h), topology.from(h)});
        ASSERT_EQ(twin, other == halfEdges.end() ? PatchTopology::kNone : other->second);
        if (twin != PatchTopology::kNone) {
            ASSERT_EQ(topology.twin(twin), h);
        }
        const std::uint32_t v = topology.from(h);
        if (topology.isMovable(v)) {
            ASSERT_EQ(topology.from(topology.leaving(v)), v);
        }
    }
}

/// Collapses edges by chance, until none may go.
void collapseAll(Patch& patch, std::mt19937& random) {
    PatchTopology topology(patch);
    Star star;
    for (;;) {
        std::vector<std::uint32_t> allowed;
        for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
            if (patch.triangles[h / 3][0] != Patch::kGone && topology.isMovable(topology.from(h)) &&
                topology.isMovable(topology.to(h)) && topology.starOfEdge(h, star)) {
                allowed.push_back(h);
            }
        }
        if (allowed.empty()) return;
        const std::uint32_t h = allowed[random() % allowed.size()];
        const std::uint32_t gone = topology.to(h);
        ASSERT_TRUE(topology.starOfEdge(h, star));
        topology.collapse(h, star);
        EXPECT_FALSE(topology.isMovable(gone));
        expectConsistent(patch, topology);
    }
}

}  // namespace

TEST(PatchTopology, KnowsTheTwinOfEveryHalfEdge) {
    Patch closed = patchOf(icosphere(1)), open = patchOf(planeMesh(3, 3));
    expectConsistent(closed, PatchTopology(closed));
    expectConsistent(open, PatchTopology(open));
}

// Every triangulated sphere but the tetrahedron has an edge that can go (Steinitz).
TEST(PatchTopology, CollapsesSpheresToTetrahedra) {
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::mt19937 random(seed);
        Patch patch = patchOf(icosphere(1));
        collapseAll(patch, random);
        const TriangleMesh mesh = meshOf(patch);
        EXPECT_EQ(mesh.points.size(), 4U);
        EXPECT_EQ(mesh.triangles.size(), 4U);
    }
}

// The triangulations of a torus without an edge that can go have seven to ten vertices, two
// triangles a vertex (Lawrencenko found all 21 of them).
TEST(PatchTopology, KeepsTheGenusOfATorus) {
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::mt19937 random(seed);
        Patch patch = patchOf(torusMesh(8, 6, 3, 1));
        collapseAll(patch, random);
        const TriangleMesh mesh = meshOf(patch);
        EXPECT_EQ(mesh.triangles.size(), 2 * mesh.points.size());
        EXPECT_GE(mesh.points.size(), 7U);
        EXPECT_LE(mesh.points.size(), 10U);
    }
}

TEST(PatchTopology, KeepsTheEdgesOfABorder) {
    std::mt19937 random(3);
    Patch patch = patchOf(planeMesh(4, 4));
    collapseAll(patch, random);
    Patch left = patchOf(meshOf(patch));
    const PatchTopology topology(left);
    int border = 0;
    for (std::uint32_t h = 0; h < 3 * left.ownTriangles; ++h) {
        border += topology.twin(h) == PatchTopology::kNone ? 1 : 0;
    }
    EXPECT_EQ(border, 16);
    EXPECT_LT(left.ownTriangles, 32U);
}

}  // namespace adaptiso::testing
