#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

// ---- The truth, in whole numbers: separating axes ------------------------------------------

struct IntVec {
    std::int64_t x = 0, y = 0, z = 0;
    friend bool operator==(const IntVec&, const IntVec&) = default;
};
IntVec operator-(const IntVec& a, const IntVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
IntVec operator*(std::int64_t s, const IntVec& a) {
    return {s * a.x, s * a.y, s * a.z};
}
std::int64_t dot(const IntVec& a, const IntVec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
IntVec cross(const IntVec& a, const IntVec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
using IntTriangle = std::array<IntVec, 3>;

IntVec normal(const IntTriangle& t) {
    return cross(t[1] - t[0], t[2] - t[0]);
}

/// A gap between them along `axis`.
bool separates(const IntVec& axis, const IntTriangle& a, const IntTriangle& b) {
    const auto range = [&](const IntTriangle& t) {
        return std::minmax({dot(axis, t[0]), dot(axis, t[1]), dot(axis, t[2])});
    };
    const auto [aLow, aHigh] = range(a);
    const auto [bLow, bHigh] = range(b);
    return aHigh < bLow || bHigh < aLow;
}

/// Closed triangles (a may be a segment, one corner twice) have a point in common: no axis
/// separates them. It is enough to look along normals, cross products of sides, and, for triangles
/// in one plane, across each side in that plane.
bool meet(const IntTriangle& a, const IntTriangle& b) {
    const IntVec na = normal(a), nb = normal(b);
    if (separates(na, a, b) || separates(nb, a, b)) return false;
    for (int i = 0; i < 3; ++i) {
        const IntVec ea = a[(i + 1) % 3] - a[i], eb = b[(i + 1) % 3] - b[i];
        for (const IntVec& axis : {cross(na, ea), cross(nb, eb), cross(nb, ea), cross(na, eb)}) {
            if (separates(axis, a, b)) return false;
        }
        for (int j = 0; j < 3; ++j) {
            if (separates(cross(ea, b[(j + 1) % 3] - b[j]), a, b)) return false;
        }
    }
    return true;
}

/// What trianglesCross promises, by other means.
bool crossInTruth(IntTriangle a, IntTriangle b) {
    if (normal(a) == IntVec{} || normal(b) == IntVec{}) return false;
    std::vector<std::pair<int, int>> shared;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (a[i] == b[j]) shared.emplace_back(i, j);
        }
    }
    if (shared.empty()) return meet(a, b);
    if (shared.size() == 3) return true;
    std::rotate(a.begin(), a.begin() + shared[0].first, a.end());
    std::rotate(b.begin(), b.begin() + shared[0].second, b.end());
    const IntVec v = a[0];
    if (shared.size() == 1) {
        // Seen from v, both are wedges; they meet outside v when a's far side meets b's wedge.
        // Small coordinates: a wedge drawn out a thousandfold reaches past everything.
        const IntVec p = a[1] - v, q = a[2] - v;
        return meet({p, q, q}, {IntVec{}, 1000 * (b[1] - v), 1000 * (b[2] - v)});
    }
    const IntVec edge = a[(shared[1].first - shared[0].first + 3) % 3] - v;
    const IntVec acrossA = cross(edge, (a[1] - v == edge ? a[2] : a[1]) - v);
    const IntVec acrossB = cross(edge, (b[1] - v == edge ? b[2] : b[1]) - v);
    return cross(acrossA, acrossB) == IntVec{} && dot(acrossA, acrossB) > 0;
}

Corners toCorners(const IntTriangle& t) {
    Corners corners;
    for (int n = 0; n < 3; ++n) {
        corners[n] = {static_cast<double>(t[n].x), static_cast<double>(t[n].y),
                      static_cast<double>(t[n].z)};
    }
    return corners;
}

IntTriangle randomTriangle(std::int64_t extent, std::uint64_t& state) {
    IntTriangle t;
    for (IntVec& p : t) {
        for (std::int64_t* value : {&p.x, &p.y, &p.z}) {
            *value = static_cast<std::int64_t>(testing::nextRandom(state) % extent);
        }
    }
    return t;
}

void addTriangle(TriangleMesh& mesh, const Corners& corners) {
    const auto first = static_cast<VertexId>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
}

std::vector<TrianglePair> bruteForcePairs(const TriangleMesh& mesh) {
    std::vector<TrianglePair> pairs;
    const auto corners = [&](std::size_t n) {
        const Triangle& t = mesh.triangles[n];
        return Corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
    };
    for (std::size_t a = 0; a < mesh.triangles.size(); ++a) {
        for (std::size_t b = a + 1; b < mesh.triangles.size(); ++b) {
            if (trianglesCross(corners(a), corners(b))) {
                pairs.push_back({static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)});
            }
        }
    }
    return pairs;
}

// ---- Two triangles ---------------------------------------------------------------------------

TEST(TrianglesCross, AgreesWithWholeNumbersOnSmallGrids) {
    // On grids of 2 to 5 points a side most pairs touch, share corners or lie in one plane.
    for (const std::int64_t extent : {2, 3, 4, 5}) {
        std::uint64_t state = static_cast<std::uint64_t>(extent);
        std::int64_t crossing = 0;
        for (int n = 0; n < 100000; ++n) {
            const IntTriangle a = randomTriangle(extent, state);
            const IntTriangle b = randomTriangle(extent, state);
            const bool truth = crossInTruth(a, b);
            crossing += truth;
            ASSERT_EQ(trianglesCross(toCorners(a), toCorners(b)), truth)
                << "extent " << extent << ", pair " << n;
            ASSERT_EQ(trianglesCross(toCorners(b), toCorners(a)), truth)
                << "extent " << extent << ", pair " << n << " exchanged";
        }
        EXPECT_GT(crossing, 10000);
        EXPECT_LT(crossing, 90000);
    }
}

TEST(TrianglesCross, AgreesWithWholeNumbersWithinOnePlane) {
    std::uint64_t state = 11;
    for (int n = 0; n < 50000; ++n) {
        IntTriangle a = randomTriangle(5, state), b = randomTriangle(5, state);
        for (IntTriangle* t : {&a, &b}) {
            for (IntVec& p : *t) p.z = 2 * p.x - p.y;  // a slanted plane
        }
        ASSERT_EQ(trianglesCross(toCorners(a), toCorners(b)), crossInTruth(a, b)) << n;
    }
}

TEST(TrianglesCross, PiercingTouchingAndMissing) {
    const Corners floor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
    const auto spike = [](double z) { return Corners{{{1, 1, z}, {1, 2, z + 3}, {2, 1, z + 3}}}; };
    EXPECT_TRUE(trianglesCross(floor, spike(-1)));
    EXPECT_TRUE(trianglesCross(floor, spike(0)));  // the tip touches
    EXPECT_FALSE(trianglesCross(floor, spike(0x1p-1000)));
}

TEST(TrianglesCross, NeighboursCrossOnlyWhenTheyOverlap) {
    const Corners base{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
    EXPECT_FALSE(trianglesCross(base, {{{0, 0, 0}, {2, 0, 0}, {0, -2, 0}}}));  // flat on
    EXPECT_FALSE(trianglesCross(base, {{{0, 0, 0}, {2, 0, 0}, {0, 0, 2}}}));   // at a right angle
    EXPECT_TRUE(trianglesCross(base, {{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}}));    // folded over
    EXPECT_FALSE(trianglesCross(base, {{{0, 0, 0}, {-1, 0, 1}, {0, -1, 1}}}));
    EXPECT_TRUE(trianglesCross(base, {{{0, 0, 0}, {1, 1, -1}, {1, 1, 1}}}));
    EXPECT_TRUE(trianglesCross(base, base));
}

TEST(TrianglesCross, LineLikeTrianglesCrossNothing) {
    const Corners base{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
    EXPECT_FALSE(trianglesCross(base, {{{0.5, 0.5, -1}, {0.5, 0.5, 0}, {0.5, 0.5, 1}}}));
    EXPECT_FALSE(trianglesCross({{{0.5, 0.5, -1}, {0.5, 0.5, 1}, {0.5, 0.5, 1}}}, base));
}

TEST(TrianglesMeet, AgreesWithWholeNumbersSharedCornersIncluded) {
    for (const std::int64_t extent : {2, 3, 4, 5}) {
        std::uint64_t state = static_cast<std::uint64_t>(extent) + 20;
        for (int n = 0; n < 50000; ++n) {
            const IntTriangle a = randomTriangle(extent, state);
            const IntTriangle b = randomTriangle(extent, state);
            const bool truth = normal(a) != IntVec{} && normal(b) != IntVec{} && meet(a, b);
            ASSERT_EQ(trianglesMeet(toCorners(a), toCorners(b)), truth)
                << "extent " << extent << ", pair " << n;
        }
    }
    const Corners base{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
    EXPECT_TRUE(trianglesMeet(base, {{{0, 0, 0}, {-1, 0, 1}, {0, -1, 1}}}));  // by a corner
    EXPECT_TRUE(trianglesMeet(base, {{{0, 0, 0}, {2, 0, 0}, {0, 0, 2}}}));    // along an edge
}

// ---- Meshes ----------------------------------------------------------------------------------

TEST(SelfIntersections, SoundShapesHaveNone) {
    for (const TriangleMesh& mesh :
         {testing::icosphere(4), testing::cubeMesh(), testing::torusMesh(50, 30, 5, 2),
          testing::planeMesh(20, 5), testing::twoSpheresTouchingAtAVertex(), TriangleMesh{}}) {
        EXPECT_EQ(findSelfIntersections(mesh).pairCount, 0);
    }
}

TEST(SelfIntersections, FindsThePairsOfAllAgainstAllInATriangleSoup) {
    TriangleMesh soup;
    std::vector<IntTriangle> triangles;
    std::uint64_t state = 3;
    for (int n = 0; n < 400; ++n) {
        IntTriangle t = randomTriangle(4, state);
        const IntVec shift{static_cast<std::int64_t>(testing::nextRandom(state) % 8),
                           static_cast<std::int64_t>(testing::nextRandom(state) % 8),
                           static_cast<std::int64_t>(testing::nextRandom(state) % 8)};
        for (IntVec& p : t) p = p - shift;
        triangles.push_back(t);
        addTriangle(soup, toCorners(t));
    }
    std::vector<TrianglePair> truth;
    for (std::size_t a = 0; a < triangles.size(); ++a) {
        for (std::size_t b = a + 1; b < triangles.size(); ++b) {
            if (crossInTruth(triangles[a], triangles[b])) {
                truth.push_back({static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)});
            }
        }
    }
    ASSERT_GT(truth.size(), 100u);
    const SelfIntersections found = findSelfIntersections(soup, {.maxPairs = 100000});
    EXPECT_EQ(found.pairs, truth);
    EXPECT_EQ(found.pairCount, static_cast<std::int64_t>(truth.size()));
}

TEST(SelfIntersections, CrossingSpheresCrossWhereTheyMeet) {
    const TriangleMesh mesh = testing::crossingSpheres(2);
    const SelfIntersections found = findSelfIntersections(mesh, {.maxPairs = 100000});
    EXPECT_EQ(found.pairs, bruteForcePairs(mesh));
    ASSERT_GT(found.pairCount, 20);
    for (const auto& [a, b] : found.pairs) {
        EXPECT_LT(a, 320);  // of the first sphere
        EXPECT_GE(b, 320);  // of the second
    }
}

TEST(SelfIntersections, UnweldedMeshHasNoneOfItsOwn) {
    TriangleMesh soup;
    const TriangleMesh sphere = testing::icosphere(2);
    for (const auto& [a, b, c] : sphere.triangles) {
        addTriangle(soup, {sphere.points[a], sphere.points[b], sphere.points[c]});
    }
    EXPECT_EQ(findSelfIntersections(soup).pairCount, 0);
}

TEST(SelfIntersections, DuplicateTriangleCrosses) {
    const TriangleMesh mesh = testing::withDuplicateTriangle(testing::icosphere(1));
    const SelfIntersections found = findSelfIntersections(mesh);
    ASSERT_EQ(found.pairCount, 1);
    EXPECT_EQ(found.pairs.front(), (TrianglePair{0, 80}));
}

TEST(SelfIntersections, BrokenMeshesAreSurvived) {
    EXPECT_EQ(findSelfIntersections(testing::withNanCoordinate(testing::icosphere(1))).pairCount,
              0);
    EXPECT_EQ(findSelfIntersections(testing::withRepeatedIndex(testing::icosphere(1))).pairCount,
              0);
    EXPECT_THROW(findSelfIntersections(testing::withIndexOutOfRange(testing::cubeMesh())),
                 InvalidInput);
    EXPECT_THROW(findSelfIntersections(testing::cubeMesh(), {.maxPairs = -1}), InvalidInput);
}

TEST(SelfIntersections, TrianglesWithNanCrossNothing) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const Corners floor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
    const Corners whole{{{1, 1, -1}, {1, 2, 2}, {2, 1, 2}}};
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            Corners broken = whole;
            broken[corner][axis] = kNan;
            TriangleMesh mesh;
            addTriangle(mesh, broken);
            addTriangle(mesh, floor);
            addTriangle(mesh, broken);
            EXPECT_EQ(findSelfIntersections(mesh).pairCount, 0) << corner << ", " << axis;
            addTriangle(mesh, whole);
            EXPECT_EQ(findSelfIntersections(mesh).pairs, (std::vector<TrianglePair>{{1, 3}}));
        }
    }
}

TEST(SelfIntersections, NamesTheFirstPairsAndCountsAll) {
    const TriangleMesh mesh = testing::crossingSpheres(2);
    const SelfIntersections all = findSelfIntersections(mesh, {.maxPairs = 100000});
    const SelfIntersections few = findSelfIntersections(mesh, {.maxPairs = 5});
    EXPECT_EQ(few.pairCount, all.pairCount);
    ASSERT_EQ(few.pairs.size(), 5u);
    EXPECT_TRUE(std::equal(few.pairs.begin(), few.pairs.end(), all.pairs.begin()));
}

TEST(SelfIntersections, AreTheSameWhateverTheNumberOfThreads) {
    const TriangleMesh mesh = testing::crossingSpheres(5);
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        return findSelfIntersections(mesh, {.maxPairs = 50});
    };
    const SelfIntersections one = run(1), two = run(2);
    EXPECT_EQ(one.pairCount, two.pairCount);
    EXPECT_EQ(one.pairs, two.pairs);
}

}  // namespace
}  // namespace adaptiso
