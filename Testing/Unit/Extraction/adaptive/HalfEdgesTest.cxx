#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/SurfaceProof/HalfEdges.h"

namespace adaptiso::testing {
namespace {

using HalfEdges = detail::HalfEdges<VertexId>;

std::vector<VertexId> twinsOf(const TriangleMesh& mesh) {
    HalfEdges halfEdges;
    halfEdges.assign(mesh.points.size(), mesh.triangles);
    std::vector<VertexId> twin;
    halfEdges.match(twin);
    return twin;
}

VertexId from(const TriangleMesh& mesh, VertexId h) {
    return mesh.triangles[h / 3][h % 3];
}
VertexId to(const TriangleMesh& mesh, VertexId h) {
    return mesh.triangles[h / 3][(h + 1) % 3];
}

/// Every twin runs the other way, and has the half-edge as its own. \return those without one
int countUnmatched(const TriangleMesh& mesh) {
    const std::vector<VertexId> twin = twinsOf(mesh);
    EXPECT_EQ(twin.size(), 3 * mesh.triangles.size());
    int unmatched = 0;
    for (VertexId h = 0; h < std::ssize(twin); ++h) {
        if (twin[h] == HalfEdges::kNone) {
            ++unmatched;
            continue;
        }
        EXPECT_EQ(twin[twin[h]], h);
        EXPECT_EQ(from(mesh, twin[h]), to(mesh, h));
        EXPECT_EQ(to(mesh, twin[h]), from(mesh, h));
    }
    return unmatched;
}

}  // namespace

TEST(HalfEdges, MatchAllOfAClosedMesh) {
    EXPECT_EQ(countUnmatched(icosphere(2)), 0);
    EXPECT_EQ(countUnmatched(torusMesh(7, 5, 3, 1)), 0);
    EXPECT_EQ(countUnmatched(cubeMesh()), 0);
}

TEST(HalfEdges, LeaveThoseOfABorderWithoutATwin) {
    EXPECT_EQ(countUnmatched(planeMesh(5, 1)), 4 * 5);
    EXPECT_EQ(countUnmatched(withHole(icosphere(1))), 3);
}

TEST(HalfEdges, MatchNoneThatRunTheSameWay) {
    // the three edges of the turned triangle, on both sides
    EXPECT_EQ(countUnmatched(withFlippedTriangle(icosphere(1))), 6);
}

TEST(HalfEdges, MatchOneOfSeveralAndRefuseTheRest) {
    TriangleMesh mesh;
    mesh.points.resize(6);
    // three triangles run from 0 to 1, two back
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 1, 5}, {1, 0, 2}};
    const std::vector<VertexId> twin = twinsOf(mesh);
    EXPECT_EQ(twin[0], 6);
    EXPECT_EQ(twin[6], 0);
    EXPECT_EQ(twin[3], 12);
    EXPECT_EQ(twin[12], 3);
    EXPECT_EQ(twin[9], HalfEdges::kNone);
    // three edges of the triangle that comes twice have three half-edges
    EXPECT_EQ(countUnmatched(withDuplicateTriangle(icosphere(1))), 3);
}

TEST(HalfEdges, MatchRoundAVertexOfManyTrianglesAsElsewhere) {
    // from 0 to each of 1 ... 40 run some, and some back
    TriangleMesh mesh;
    mesh.points.resize(41);
    std::vector<std::int64_t> there(41), back(41);
    for (VertexId v = 1; v <= 40; ++v) {
        for (VertexId n = 0; n < v % 4; ++n) mesh.triangles.push_back({0, v, v % 40 + 1});
    }
    const std::vector<VertexId> twin = twinsOf(mesh);
    for (const Triangle& t : mesh.triangles) {
        ++there[t[1]];
        ++back[t[2]];
    }
    std::vector<std::int64_t> matched(41);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (twin[3 * t] == HalfEdges::kNone) continue;
        const auto& other = mesh.triangles[twin[3 * t] / 3];
        EXPECT_EQ(twin[3 * t] % 3, 2);
        EXPECT_EQ(other[2], mesh.triangles[t][1]);
        EXPECT_EQ(static_cast<std::size_t>(twin[twin[3 * t]]), 3 * t);
        ++matched[other[2]];
    }
    for (VertexId v = 1; v <= 40; ++v) EXPECT_EQ(matched[v], std::min(there[v], back[v])) << v;
}

TEST(HalfEdges, AreListedByTheirVertexInAscendingOrder) {
    const TriangleMesh mesh = planeMesh(4, 1);
    HalfEdges halfEdges;
    halfEdges.assign(mesh.points.size(), mesh.triangles);
    std::size_t listed = 0;
    for (VertexId v = 0; v < std::ssize(mesh.points); ++v) {
        const auto leaving = halfEdges.from(v);
        listed += leaving.size();
        for (std::size_t i = 0; i < leaving.size(); ++i) {
            EXPECT_EQ(from(mesh, leaving[i]), v);
            EXPECT_EQ(to(mesh, leaving[i]), halfEdges.to(leaving[i]));
            if (i > 0) {
                EXPECT_LT(leaving[i - 1], leaving[i]);
            }
        }
    }
    EXPECT_EQ(listed, 3 * mesh.triangles.size());
}

// Edges between them and the others are like those of a border.
TEST(HalfEdges, MayBeOfSomeTrianglesAlone) {
    const TriangleMesh mesh = icosphere(1);
    const std::vector<VertexId> all = twinsOf(mesh);
    // a triangle and those around it
    std::vector<VertexId> some{3, all[9] / 3, all[10] / 3, all[11] / 3};
    std::sort(some.begin(), some.end());
    HalfEdges halfEdges;
    halfEdges.assign(mesh.points.size(), mesh.triangles, some);
    std::vector<VertexId> twin;
    halfEdges.match(twin);
    const auto isMeant = [&](VertexId h) {
        return std::find(some.begin(), some.end(), h / 3) != some.end();
    };
    int matched = 0;
    for (VertexId h = 0; h < std::ssize(all); ++h) {
        const bool isInner = isMeant(h) && isMeant(all[h]);
        EXPECT_EQ(twin[h], isInner ? all[h] : HalfEdges::kNone);
        matched += isInner ? 1 : 0;
    }
    EXPECT_EQ(matched, 6);
    for (VertexId v = 0; v < std::ssize(mesh.points); ++v) {
        for (const VertexId h : halfEdges.from(v)) EXPECT_TRUE(isMeant(h));
    }
}

// Beyond 32,768 triangles several threads work.
TEST(HalfEdges, AreTheSameForManyTriangles) {
    const TriangleMesh one = withDuplicateTriangle(withHole(torusMesh(20, 10, 3, 1)));
    const std::vector<VertexId> expected = twinsOf(one);
    TriangleMesh many;
    constexpr VertexId kCopies = 100;
    const VertexId points = std::ssize(one.points);
    many.points.resize(kCopies * points);
    for (VertexId copy = 0; copy < kCopies; ++copy) {
        for (const auto& [a, b, c] : one.triangles) {
            many.triangles.push_back({a + copy * points, b + copy * points, c + copy * points});
        }
    }
    ASSERT_GT(many.triangles.size(), 32768U);
    const std::vector<VertexId> twin = twinsOf(many);
    for (VertexId h = 0; h < std::ssize(twin); ++h) {
        const VertexId first = h / std::ssize(expected) * std::ssize(expected),
                       alone = expected[h - first];
        ASSERT_EQ(twin[h], alone == HalfEdges::kNone ? alone : first + alone) << h;
    }
    HalfEdges halfEdges;
    halfEdges.assign(many.points.size(), many.triangles);
    for (VertexId v = 0; v < std::ssize(many.points); ++v) {
        VertexId last = -1;
        for (const VertexId h : halfEdges.from(v)) {
            ASSERT_LT(last, h);
            ASSERT_EQ(from(many, h), v);
            last = h;
        }
    }
}

TEST(HalfEdges, ForgetTheLastMesh) {
    const TriangleMesh large = icosphere(2), small = planeMesh(1, 1);
    HalfEdges halfEdges;
    std::vector<VertexId> twin;
    for (const TriangleMesh* mesh : {&large, &small}) {
        halfEdges.assign(mesh->points.size(), mesh->triangles);
        halfEdges.match(twin);
    }
    EXPECT_EQ(twin, twinsOf(small));
}

}  // namespace adaptiso::testing
