#include <gtest/gtest.h>

#include "EditMesh.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

using namespace adaptiso::testing;
using HalfEdge = EditMesh::HalfEdge;

TEST(EditMesh, GivesBackWhatItTook) {
    const TriangleMesh cube = cubeMesh();
    EXPECT_EQ(EditMesh(cube).toMesh(), cube);
}

TEST(EditMesh, LeavesUnusedVerticesOut) {
    const EditMesh mesh(withUnusedVertex(cubeMesh()));
    EXPECT_EQ(mesh.vertexCount(), 8);
    EXPECT_EQ(mesh.toMesh(), cubeMesh());
}

TEST(EditMesh, KnowsTheCornersAroundAnEdge) {
    const EditMesh mesh(icosphere(0));
    for (HalfEdge h = 0; h < mesh.halfEdgeSlots(); ++h) {
        EXPECT_EQ(mesh.from(h), mesh.to(mesh.twin(h)));
        EXPECT_EQ(mesh.to(h), mesh.from(mesh.twin(h)));
        EXPECT_NE(mesh.opposite(h), mesh.opposite(mesh.twin(h)));
        EXPECT_EQ(mesh.valence(mesh.from(h)), 5);  // an icosahedron's
    }
}

TEST(EditMesh, SplitAddsOneVertexTwoTrianglesAndNoVolume) {
    EditMesh mesh(cubeMesh());
    const VertexId m = mesh.split(0, 0.5 * (mesh.point(mesh.from(0)) + mesh.point(mesh.to(0))));
    EXPECT_EQ(mesh.valence(m), 4);
    const TriangleMesh result = mesh.toMesh();
    EXPECT_EQ(result.points.size(), 9);
    EXPECT_EQ(result.triangles.size(), 14);
    EXPECT_EQ(enclosedVolume(result), 1);  // halves are exact
    expectSound(result);
}

TEST(EditMesh, GoesOnAfterCompactingAsItWouldHave) {
    EditMesh mesh(icosphere(3));
    const auto collapseSome = [](EditMesh& edited, int oneIn) {
        for (HalfEdge h = 0; h < edited.halfEdgeSlots(); h += oneIn) {
            if (edited.isAlive(h) && edited.canCollapse(h)) edited.collapse(h);
        }
    };
    collapseSome(mesh, 4);
    EditMesh compacted = mesh;
    const std::vector<VertexId> former = compacted.compact();
    EXPECT_EQ(compacted.toMesh(), mesh.toMesh());
    EXPECT_EQ(compacted.vertexCount(), mesh.vertexCount());
    EXPECT_LT(compacted.vertexSlots(), mesh.vertexSlots());
    ASSERT_EQ(std::ssize(former), compacted.vertexSlots());
    for (VertexId v = 0; v < compacted.vertexSlots(); ++v) {
        ASSERT_EQ(compacted.isVertexAlive(v), mesh.isVertexAlive(former[v]));
        if (!compacted.isVertexAlive(v)) continue;
        ASSERT_EQ(compacted.point(v), mesh.point(former[v]));
    }
    for (EditMesh* edited : {&mesh, &compacted}) {
        std::int64_t wanted = edited->vertexCount() / 2;
        for (HalfEdge h = 0; h < edited->halfEdgeSlots() && wanted > 0; ++h) {
            if (!edited->isFirst(h)) continue;
            edited->split(h, 0.5 * (edited->point(edited->from(h)) + edited->point(edited->to(h))));
            --wanted;
        }
    }
    EXPECT_EQ(compacted.toMesh(), mesh.toMesh());
    expectSound(compacted.toMesh());
}

TEST(EditMesh, CollapseUndoesASplit) {
    EditMesh mesh(icosphere(1));
    const TriangleMesh before = mesh.toMesh();
    const VertexId b = mesh.to(0);
    const VertexId m = mesh.split(0, {0, 0, 9});
    HalfEdge back = -1;
    mesh.forEachOut(m, [&](HalfEdge h) {
        if (mesh.to(h) == b) back = h;
    });
    ASSERT_TRUE(mesh.canCollapse(back));
    mesh.collapse(back);
    EXPECT_EQ(mesh.toMesh().points, before.points);
    EXPECT_DOUBLE_EQ(enclosedVolume(mesh.toMesh()), enclosedVolume(before));
    expectSound(mesh.toMesh());
}

TEST(EditMesh, FlipOfACubesDiagonalKeepsTheCube) {
    EditMesh mesh(cubeMesh());
    HalfEdge diagonal = 0;
    while (mesh.squaredLength(diagonal) < 1.5) ++diagonal;
    const VertexId c = mesh.opposite(diagonal), d = mesh.opposite(mesh.twin(diagonal));
    ASSERT_TRUE(mesh.canFlip(diagonal));
    mesh.flip(diagonal);
    bool isJoined = false;
    mesh.forEachOut(c, [&](HalfEdge h) { isJoined = isJoined || mesh.to(h) == d; });
    EXPECT_TRUE(isJoined);
    EXPECT_DOUBLE_EQ(enclosedVolume(mesh.toMesh()), 1);
    expectSound(mesh.toMesh());
}

TEST(EditMesh, RefusesWhatWouldBreakATetrahedron) {
    TriangleMesh tetrahedron;
    tetrahedron.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const EditMesh mesh(tetrahedron);
    for (HalfEdge h = 0; h < mesh.halfEdgeSlots(); ++h) {
        EXPECT_FALSE(mesh.canCollapse(h));
        EXPECT_FALSE(mesh.canFlip(h));
    }
}

TEST(EditMesh, RefusesToPinchAThinRing) {
    // Three steps round the tube: its edges' ends have the third vertex of the ring in common.
    const EditMesh mesh(torusMesh(12, 3, 10, 2));
    int refused = 0;
    for (HalfEdge h = 0; h < mesh.halfEdgeSlots(); ++h) {
        const bool isRound = mesh.from(h) / 3 == mesh.to(h) / 3;  // both of one ring
        if (isRound) {
            EXPECT_FALSE(mesh.canCollapse(h));
            ++refused;
        }
    }
    EXPECT_EQ(refused, 2 * 12 * 3);
}

/// Any edits that are allowed leave a closed manifold of the same genus.
void editAtRandom(TriangleMesh start, std::int64_t genus, std::uint64_t seed) {
    EditMesh mesh(start);
    for (int step = 0; step < 3000; ++step) {
        const auto h = static_cast<HalfEdge>(nextRandom(seed) % mesh.halfEdgeSlots());
        if (!mesh.isAlive(h)) continue;
        switch (nextRandom(seed) % 3) {
            case 0:
                if (mesh.canFlip(h)) mesh.flip(h);
                break;
            case 1:
                if (mesh.canCollapse(h)) mesh.collapse(h);
                break;
            default:
                if (step % 2 == 0) {
                    mesh.split(h, 0.5 * (mesh.point(mesh.from(h)) + mesh.point(mesh.to(h))));
                }
        }
    }
    const TriangleMesh end = mesh.toMesh();
    EXPECT_EQ(std::ssize(end.points), mesh.vertexCount());
    const TopologyReport report = checkTopology(end);
    EXPECT_TRUE(report.isWatertight());
    EXPECT_EQ(report.count(TopologyDefect::DuplicateTriangle), 0);
    EXPECT_EQ(report.count(TopologyDefect::UnusedVertex), 0);
    EXPECT_EQ(report.components.size(), 1);
    EXPECT_EQ(report.genus(), genus);
}

TEST(EditMesh, AnyAllowedEditsKeepTheTopology) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        editAtRandom(icosphere(2), 0, seed);
        editAtRandom(torusMesh(12, 6, 10, 3), 1, seed);
    }
}

}  // namespace
}  // namespace adaptiso
