#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "adaptiso-giant/BorderFront.h"

namespace adaptiso::giant {
namespace {

/// Rings of a tube that is bent to a torus, each a piece of its own: `count` of `sides` vertices.
std::vector<PieceSummary> rings(int count, int sides) {
    const auto at = [&](int ring, int side) {
        const double u = 2 * std::numbers::pi * (ring % count) / count,
                     v = 2 * std::numbers::pi * (side % sides) / sides;
        return Vec3{(3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v)};
    };
    ImageGeometry geometry;
    geometry.size = {8, 8, 8};
    geometry.indexToPhysical = Mat3::diagonal(1, 1, 1);
    std::vector<PieceSummary> pieces;
    for (int ring = 0; ring < count; ++ring) {
        TriangleMesh mesh;
        for (int side = 0; side < sides; ++side) {
            mesh.points.push_back(at(ring, side));
            mesh.points.push_back(at(ring + 1, side));
        }
        for (VertexId side = 0; side < sides; ++side) {
            const VertexId a = 2 * side, b = 2 * ((side + 1) % sides);
            mesh.triangles.push_back({a, a + 1, b});
            mesh.triangles.push_back({b, a + 1, b + 1});
        }
        summarize(mesh, geometry, pieces.emplace_back());
    }
    return pieces;
}

TEST(BorderFront, HoldsARingOrThreeOfATubeHoweverLong) {
    constexpr int kSides = 10;
    for (const int count : {5, 50, 500}) {
        BorderFront front;
        std::int64_t seen = 0, forgotten = 0;
        for (const PieceSummary& piece : rings(count, kSides)) {
            ASSERT_EQ(piece.border.size(), 2 * kSides);
            for (const BorderFront::Vertex* v : front.add(piece)) seen += v->isNew ? 1 : 0;
            front.release(piece, [&](const BorderFront::Vertex&) { ++forgotten; });
        }
        EXPECT_EQ(seen, count * kSides);
        EXPECT_EQ(forgotten, count * kSides);
        EXPECT_EQ(front.openEdges(), 0);
        EXPECT_EQ(front.longest(), 3 * kSides);  // the first, the last, and the one between
    }
}

TEST(BorderFront, NumbersStayWhileAVertexIsHeld) {
    const std::vector<PieceSummary> pieces = rings(6, 4);
    BorderFront front;
    for (BorderFront::Vertex* v : front.add(pieces[0])) v->number = 100;
    front.release(pieces[0], [](const BorderFront::Vertex&) { FAIL(); });
    std::int64_t known = 0;
    for (const BorderFront::Vertex* v : front.add(pieces[1])) known += v->number == 100 ? 1 : 0;
    EXPECT_EQ(known, 4);
    EXPECT_EQ(front.openEdges(), 8);
}

TEST(BorderFront, APieceThatIsMissingLeavesOpenEdges) {
    BorderFront front;
    std::vector<PieceSummary> pieces = rings(6, 4);
    pieces.erase(pieces.begin() + 2);
    for (const PieceSummary& piece : pieces) {
        front.add(piece);
        front.release(piece, [](const BorderFront::Vertex&) {});
    }
    EXPECT_EQ(front.openEdges(), 8);
}

}  // namespace
}  // namespace adaptiso::giant
