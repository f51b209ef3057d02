#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"

namespace adaptiso::testing {
namespace {

using detail::ConvexPiece;
using detail::SurfaceWalk;
using Walkable = detail::WalkableSurface<VertexId>;

constexpr int kManySteps = 10000;

bool isCovered(const Corners& piece, const Walkable& surface, double distanceMm,
               int steps = kManySteps) {
    SurfaceWalk walk;
    walk.cover(ConvexPiece(piece), surface, VertexId{0}, distanceMm * distanceMm, steps);
    return walk.left().empty();
}

/// Hills over the square from 0 to 10.
TriangleMesh hills() {
    TriangleMesh mesh = planeMesh(20, 10);
    for (Vec3& p : mesh.points) p.z = 0.4 * std::sin(p.x) * std::cos(1.3 * p.y);
    return mesh;
}

Walkable walkable(const TriangleMesh& mesh) {
    Walkable surface;
    surface.assign(mesh.points, mesh.triangles);
    return surface;
}

}  // namespace

TEST(WalkableSurface, KnowsTheTriangleAcrossEachEdge) {
    const TriangleMesh mesh = planeMesh(3, 3);
    const Walkable surface = walkable(mesh);
    int borders = 0;
    for (VertexId t = 0; t < std::ssize(mesh.triangles); ++t) {
        for (int c = 0; c < 3; ++c) {
            const VertexId next = surface.across(t, c);
            if (next == Walkable::kNone) {
                ++borders;
                continue;
            }
            const VertexId a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
            const VertexId third = mesh.triangles[t][(c + 2) % 3];
            EXPECT_EQ(surface.find(a, b, third), t);
            EXPECT_EQ(surface.find(b, a, third), Walkable::kNone);
            EXPECT_NE(next, t);
            int shared = 0;
            for (const VertexId v : mesh.triangles[next]) shared += v == a || v == b ? 1 : 0;
            EXPECT_EQ(shared, 2);
        }
    }
    EXPECT_EQ(borders, 12);
}

TEST(WalkableSurface, FindsTrianglesAlsoWithoutFans) {
    // around the plane's border points fans are open to both sides, elsewhere they are closed
    for (const TriangleMesh& mesh : {planeMesh(3, 3), icosphere(1)}) {
        const Walkable whole = walkable(mesh);
        Walkable surface = walkable(mesh);
        surface.forgetFans();
        for (VertexId t = 0; t < std::ssize(mesh.triangles); ++t) {
            for (int c = 0; c < 3; ++c) {
                const VertexId a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3],
                               third = mesh.triangles[t][(c + 2) % 3];
                EXPECT_EQ(surface.find(a, b, third), t);
                EXPECT_EQ(surface.find(b, a, third), Walkable::kNone);
                EXPECT_EQ(surface.triangleAt(a), whole.triangleAt(a));
            }
        }
    }
}

TEST(SurfaceWalk, CoversWhatLiesWithinTheDistanceOfAPlane) {
    const TriangleMesh mesh = planeMesh(8, 8);
    const Walkable surface = walkable(mesh);
    const Corners piece{Vec3{1, 1, 0.5}, Vec3{7, 2, 0.5}, Vec3{3, 6, 0.5}};
    EXPECT_TRUE(isCovered(piece, surface, 0.501));
    EXPECT_FALSE(isCovered(piece, surface, 0.499));
}

TEST(SurfaceWalk, LeavesWhatHangsOverTheBorder) {
    const TriangleMesh mesh = planeMesh(8, 8);
    const Walkable surface = walkable(mesh);
    const Corners piece{Vec3{7, 2, 0}, Vec3{9, 4, 0}, Vec3{7, 6, 0}};  // by 1
    EXPECT_TRUE(isCovered(piece, surface, 1.01));
    EXPECT_FALSE(isCovered(piece, surface, 0.9));
}

TEST(SurfaceWalk, LeavesAllWhereItMayVisitNoTriangle) {
    const TriangleMesh mesh = planeMesh(8, 8);
    const Walkable surface = walkable(mesh);
    const Corners piece{Vec3{1, 1, 0}, Vec3{7, 2, 0}, Vec3{3, 6, 0}};
    SurfaceWalk walk;
    walk.cover(ConvexPiece(piece), surface, VertexId{0}, 1e-4, 0);
    ASSERT_EQ(walk.left().size(), 1U);
    ASSERT_EQ(walk.left()[0].count(), 3);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(walk.left()[0].corner(i), piece[i]);
    EXPECT_FALSE(isCovered(piece, surface, 0.01, 3));
    EXPECT_TRUE(isCovered(piece, surface, 0.01));
}

// A walk over hills, to a copy of each of their triangles: it lies as far off as it was lifted.
TEST(SurfaceWalk, CoversEveryTriangleOfTheSameSurface) {
    const TriangleMesh mesh = hills();
    const Walkable surface = walkable(mesh);
    for (VertexId t = 0; t < std::ssize(mesh.triangles); ++t) {
        EXPECT_TRUE(isCovered(surface.cornersOf(t), surface, 1e-6)) << t;
    }
}

// What is covered lies within the distance, at every point.
// Found by label maps far from the origin: what rounding had bent was cut into more corners than
// there is room for.
TEST(SurfaceWalk, LeavesPiecesThatWouldGetTooManyCorners) {
    const TriangleMesh mesh = planeMesh(1, 1);
    const Walkable surface = walkable(mesh);
    for (const bool rises : {true, false}) {  // along the diagonal between both triangles
        for (int corners = 4; corners <= ConvexPiece::kMost; ++corners) {
            ConvexPiece zigzag;
            for (int i = 0; i < corners; ++i) {
                const double x = 0.1 + 0.8 * i / corners, y = rises ? x : 1 - x;
                zigzag.add({x, i % 2 == 0 ? y + 0.05 : y - 0.05, 0.5});
            }
            SurfaceWalk walk;
            walk.cover(zigzag, surface, VertexId{0}, 1e-6, kManySteps);
            EXPECT_FALSE(walk.left().empty());
            for (const ConvexPiece& piece : walk.left()) {
                EXPECT_LE(piece.count(), ConvexPiece::kMost);
            }
        }
    }
}

TEST(SurfaceWalk, CoversNothingBeyondTheDistance) {
    const TriangleMesh mesh = hills();
    const Walkable surface = walkable(mesh);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0, 1);
    int covered = 0;
    constexpr double kDistance = 0.3;
    for (int n = 0; n < 200; ++n) {
        Corners piece;
        const Vec3 middle = Vec3{5, 5, 0} + randomPoint(random, 4);
        for (Vec3& p : piece) {
            p = middle + randomPoint(random, 1);
            p.z = 0.4 * std::sin(p.x) * std::cos(1.3 * p.y) + 0.4 * (2 * part(random) - 1);
        }
        if (!isCovered(piece, surface, kDistance)) continue;
        ++covered;
        for (int i = 0; i < 20; ++i) {
            double u = part(random), v = part(random);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            ASSERT_LE(distanceTo(mesh, (1 - u - v) * piece[0] + u * piece[1] + v * piece[2]),
                      kDistance * (1 + 1e-9))
                << n;
        }
    }
    EXPECT_GT(covered, 50);
    EXPECT_LT(covered, 190);
}

// Above vertices whose half-way planes do not meet in a line some pieces go round and round: with
// steps for minutes the walk ends at once, and leaves what it left after fewer.
TEST(SurfaceWalk, EndsWhereAPieceGoesInCircles) {
    TriangleMesh mesh = planeMesh(8, 8);
    std::mt19937 random(7);
    for (Vec3& p : mesh.points) p = p + randomPoint(random, 0.9);
    const Walkable surface = walkable(mesh);
    SurfaceWalk few, many;
    for (int n = 0; n < 2000; ++n) {
        const Vec3 at = Vec3{4, 4, 0} + randomPoint(random, 4);
        const ConvexPiece piece(
            Corners{at, at + randomPoint(random, 0.01), at + randomPoint(random, 0.01)});
        few.cover(piece, surface, VertexId{0}, 1e-12, kManySteps);
        many.cover(piece, surface, VertexId{0}, 1e-12, std::numeric_limits<int>::max());
        ASSERT_EQ(few.left().size(), many.left().size()) << n;
    }
}

}  // namespace adaptiso::testing
