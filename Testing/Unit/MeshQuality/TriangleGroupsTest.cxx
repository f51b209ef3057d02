// What many triangles near each other cost: counts of tests, never seconds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "ExactCrossing.h"
#include "Support/Meshes.h"
#include "TriangleGroups.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Winding.h"

namespace adaptiso::testing {
namespace {

/// A mesh with triangles by 32-bit numbers.
struct Numbered {
    explicit Numbered(TriangleMesh of) : mesh(std::move(of)) {
        for (const auto& [a, b, c] : mesh.triangles) {
            triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                 static_cast<std::uint32_t>(c)});
        }
    }
    TriangleView view() const { return {mesh.points, triangles}; }

    TriangleMesh mesh;
    std::vector<TriangleView::Triangle> triangles;
};

Vec3 onCircle(double turn, double radius, double z) {
    const double angle = 2 * std::numbers::pi * turn;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// No axis is one of the coordinates'.
Vec3 turned(const Vec3& p) {
    return {0.8 * p.x - 0.6 * p.y, 0.48 * p.x + 0.64 * p.y - 0.6 * p.z,
            0.36 * p.x + 0.48 * p.y + 0.8 * p.z};
}

/// Two vertices of half of the triangles each. \param inner  radius of every other vertex of the
/// rim
TriangleMesh bipyramid(std::int64_t triangles, double inner = 50) {
    const std::int64_t count = triangles / 2;
    TriangleMesh mesh;
    mesh.points = {turned({0, 0, 50}), turned({0, 0, -50})};
    for (std::int64_t n = 0; n < count; ++n) {
        const double turn = static_cast<double>(n) / static_cast<double>(count);
        mesh.points.push_back(turned(onCircle(turn, n % 2 == 0 ? 50 : inner, 0)));
        const VertexId a = 2 + n, b = 2 + (n + 1) % count;
        mesh.triangles.push_back({0, a, b});
        mesh.triangles.push_back({1, b, a});
    }
    return mesh;
}

TriangleMesh inAnyOrder(TriangleMesh mesh) {
    std::mt19937 random(5);
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    return mesh;
}

/// A tube of needles, open at its ends.
TriangleMesh needles(std::int64_t triangles) {
    const std::int64_t count = triangles / 2;
    TriangleMesh mesh;
    for (std::int64_t n = 0; n < count; ++n) {
        const double turn = static_cast<double>(n) / static_cast<double>(count);
        mesh.points.push_back(turned(onCircle(turn, 50, -50)));
        mesh.points.push_back(turned(onCircle(turn + 0.1, 50, 50)));
        const VertexId a = 2 * n, b = 2 * ((n + 1) % count);
        mesh.triangles.push_back({a, b, a + 1});
        mesh.triangles.push_back({b, b + 1, a + 1});
    }
    return mesh;
}

/// Triangles round an edge.
TriangleMesh onAnEdge(std::int64_t triangles) {
    TriangleMesh mesh;
    mesh.points = {turned({0, 0, 0}), turned({0, 0, 50})};
    for (std::int64_t n = 0; n < triangles; ++n) {
        const double turn = static_cast<double>(n) / static_cast<double>(triangles);
        mesh.points.push_back(turned(onCircle(turn, 50, 25)));
        mesh.triangles.push_back({0, 1, 2 + n});
    }
    return mesh;
}

/// Octahedra within each other; every other faces inward if they alternate.
TriangleMesh shells(std::int64_t count, bool doAlternate = false) {
    constexpr std::array<Triangle, 8> kFaces{
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    TriangleMesh mesh;
    for (std::int64_t n = 0; n < count; ++n) {
        const double r = 10 + 90 * static_cast<double>(n + 1) / static_cast<double>(count);
        const VertexId first = 6 * n;
        for (const Vec3& p : {Vec3{r, 0, 0}, Vec3{-r, 0, 0}, Vec3{0, r, 0}, Vec3{0, -r, 0},
                              Vec3{0, 0, r}, Vec3{0, 0, -r}}) {
            mesh.points.push_back(p);
        }
        for (auto [a, b, c] : kFaces) {
            if (doAlternate && (count - n) % 2 == 0) std::swap(b, c);
            mesh.triangles.push_back({first + a, first + b, first + c});
        }
    }
    return mesh;
}

/// Triangles that all pass the origin.
TriangleMesh crossingAtOnePoint(int triangles) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    TriangleMesh mesh;
    for (int n = 0; n < triangles; ++n) {
        const Vec3 p{normal(random), normal(random), normal(random)},
            q{normal(random), normal(random), normal(random)};
        mesh.points.insert(mesh.points.end(), {p, q, -(p + q)});
        mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
    }
    return mesh;
}

}  // namespace

TEST(TriangleGroups, FindExactlyWhatCrossesInSoups) {
    std::mt19937 random(8);
    std::int64_t found = 0;
    for (int n = 0; n < 300; ++n) {
        // few points: many triangles share a corner or an edge
        const IntegerSoup soup = randomSoup(random, 12 + 3 * (n % 60), 120, 1000);
        const Numbered numbered(soup.mesh());
        const TriangleView view = numbered.view();
        std::set<std::array<std::uint32_t, 2>> expected;
        for (std::uint32_t s = 0; s < view.triangles.size(); ++s) {
            for (std::uint32_t t = s + 1; t < view.triangles.size(); ++t) {
                if (trianglesCross(view.cornersOf(s), view.cornersOf(t))) expected.insert({s, t});
            }
        }
        const TriangleGroups::Pairs pairs =
            TriangleGroups(view).findPairs([&](std::uint32_t s, std::uint32_t t) {
                return trianglesCross(view.cornersOf(s), view.cornersOf(t));
            });
        ASSERT_TRUE(pairs.undecided.empty());
        ASSERT_EQ(pairs.pairs.size(), expected.size()) << n;
        ASSERT_EQ(std::set(pairs.pairs.begin(), pairs.pairs.end()), expected) << n;
        found += std::ssize(pairs.pairs);
    }
    EXPECT_GT(found, 10000);
}

TEST(TriangleGroups, FindExactlyWhatMeetsOfTwoSoups) {
    std::mt19937 random(9);
    for (int n = 0; n < 100; ++n) {
        const Numbered one(randomSoup(random, 40, 60, 1000).mesh()),
            two(randomSoup(random, 40, 90, 1000).mesh());
        const TriangleView a = one.view(), b = two.view();
        const auto meet = [&](std::uint32_t s, std::uint32_t t) {
            return trianglesMeet(a.cornersOf(s), b.cornersOf(t));
        };
        std::set<std::array<std::uint32_t, 2>> expected;
        for (std::uint32_t s = 0; s < a.triangles.size(); ++s) {
            for (std::uint32_t t = 0; t < b.triangles.size(); ++t) {
                if (meet(s, t)) expected.insert({s, t});
            }
        }
        const TriangleGroups::Pairs pairs = TriangleGroups(a).findPairs(TriangleGroups(b), 0, meet);
        ASSERT_EQ(std::set(pairs.pairs.begin(), pairs.pairs.end()), expected) << n;
    }
}

// Boxes along the axes all overlap here: hundreds of millions of pairs.
TEST(CrossingPairs, OfSoundMeshesCostAFewTestsATriangleWhateverTheValence) {
    const std::int64_t count = 20000;
    for (const TriangleMesh& mesh :
         {bipyramid(count), inAnyOrder(bipyramid(count)), inAnyOrder(bipyramid(count, 15)),
          inAnyOrder(needles(count)), inAnyOrder(onAnEdge(count)), inAnyOrder(shells(count / 8)),
          merged({bipyramid(count / 2), translated(bipyramid(count / 2), turned({0, 0, 100}))})}) {
        const Numbered numbered(mesh);
        const CrossingPairs found = findCrossingPairs(numbered.view());
        EXPECT_TRUE(found.pairs.empty());
        EXPECT_TRUE(found.undecided.empty());
        EXPECT_LE(found.tests, 32 * count);
    }
}

TEST(CrossingPairs, OfAFanWithOneTriangleThroughItAreThatTriangles) {
    const TriangleMesh pin{
        {turned({30, 1, 0.5}), turned({30, 1, 60}), turned({30.01, 1, 60})}, {}, {{0, 1, 2}}};
    const TriangleMesh mesh = merged({bipyramid(20000), pin});
    const SelfIntersections found = findSelfIntersections(mesh);
    EXPECT_TRUE(found.isComplete);
    ASSERT_GE(found.pairCount, 1);
    for (const TrianglePair& pair : found.pairs) EXPECT_EQ(pair[1], 20000);
}

TEST(CrossingPairs, OfTrianglesThatAllCrossEndWithABudget) {
    constexpr int kCount = 12000;
    const Numbered numbered(crossingAtOnePoint(kCount));
    const CrossingPairs found = findCrossingPairs(numbered.view());
    EXPECT_GT(found.pairs.size(), 1000000U);
    EXPECT_GT(found.undecided.size(), 10000U);
    EXPECT_LE(found.tests, std::int64_t{16} << 20);
    const ThreadLimitGuard one(1);
    const CrossingPairs again = findCrossingPairs(numbered.view());
    EXPECT_EQ(again.pairs, found.pairs);
    EXPECT_EQ(again.undecided, found.undecided);

    const SelfIntersections reported = findSelfIntersections(numbered.mesh, {.maxPairs = 5});
    EXPECT_FALSE(reported.isComplete);
    EXPECT_FALSE(reported.isClear());
    EXPECT_EQ(reported.pairCount, std::ssize(found.pairs));
    EXPECT_EQ(reported.pairs.size(), 5U);
    EXPECT_EQ(crossingText(reported).find("more than "), 0U);
    EXPECT_EQ(crossingTriangles(numbered.mesh).size(), std::size_t{kCount});
    const CrossingTriangles triangles = findCrossingTriangles(numbered.mesh);
    EXPECT_EQ(triangles.found.size() + triangles.undecided.size(), std::size_t{kCount});
    EXPECT_GT(triangles.found.size(), std::size_t{kCount / 2});
}

// 500 triangles each cross all others: few enough for an exact count.
TEST(CrossingPairs, OfFewTrianglesAreAllCounted) {
    const TriangleMesh mesh = crossingAtOnePoint(1600);
    const SelfIntersections found = findSelfIntersections(mesh);
    std::int64_t expected = 0;
    for (std::int64_t s = 0; s < 1600; ++s) {
        for (std::int64_t t = 0; t < s; ++t) {
            expected += trianglesCross(cornersOf(mesh, s), cornersOf(mesh, t)) ? 1 : 0;
        }
    }
    EXPECT_TRUE(found.isComplete);
    EXPECT_EQ(found.pairCount, expected);
}

// Many triangles in any order are sorted by space; reports name them as they are stored.
TEST(CrossingPairs, AreThoseOfTheMeshWhateverItsOrder) {
    const TriangleMesh inOrder = merged({icosphere(6, {}, 50), icosphere(3, {49, 1, 2}, 10)});
    ASSERT_GT(inOrder.triangles.size(), std::size_t{1} << 15);
    std::mt19937 random(5);
    std::vector<VertexId> number(inOrder.points.size());
    std::vector<std::int64_t> place(inOrder.triangles.size());
    std::iota(number.begin(), number.end(), 0);
    std::iota(place.begin(), place.end(), 0);
    std::shuffle(number.begin(), number.end(), random);
    std::shuffle(place.begin(), place.end(), random);
    TriangleMesh mixed = inOrder;
    for (std::size_t v = 0; v < number.size(); ++v) mixed.points[number[v]] = inOrder.points[v];
    for (std::size_t t = 0; t < place.size(); ++t) {
        Triangle& moved = mixed.triangles[place[t]];
        moved = inOrder.triangles[t];
        for (VertexId& v : moved) v = number[v];
    }
    constexpr std::int64_t kAll = 1 << 20;
    const SelfIntersections expected = findSelfIntersections(inOrder, {.maxPairs = kAll}),
                            found = findSelfIntersections(mixed, {.maxPairs = kAll});
    ASSERT_GT(expected.pairCount, 50);
    std::vector<TrianglePair> pairs;
    for (const auto& [a, b] : expected.pairs) {
        pairs.push_back({std::min(place[a], place[b]), std::max(place[a], place[b])});
    }
    std::ranges::sort(pairs);
    EXPECT_EQ(found.pairs, pairs);
    std::vector<std::int64_t> triangles;
    for (const auto& pair : pairs) triangles.insert(triangles.end(), pair.begin(), pair.end());
    std::ranges::sort(triangles);
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    EXPECT_EQ(crossingTriangles(mixed), triangles);
}

TEST(CrossingPairs, LeaveOutTrianglesWithoutArea) {
    TriangleMesh mesh;
    for (int n = 0; n < 30000; ++n) {
        const double at = n * 7919 % 30000;
        mesh.points.push_back({at, at, at});
    }
    for (VertexId n = 0; n < 30000; n += 3) mesh.triangles.push_back({n, n + 1, n + 2});
    EXPECT_TRUE(findSelfIntersections(mesh).isClear());
}

TEST(CrossingPairs, AreToldInWords) {
    EXPECT_EQ(foundText(1234, true), "1,234");
    EXPECT_EQ(foundText(1234, false), "more than 1,200");
    EXPECT_EQ(foundText(1, false), "at least 1");
    EXPECT_EQ(pairsText(1, true), "1 pair");
    EXPECT_EQ(pairsText(1234, true), "1,234 pairs");
    EXPECT_EQ(pairsText(1, false), "at least 1 pair");
    EXPECT_EQ(pairsText(4167952, false), "more than 4,100,000 pairs");
    EXPECT_EQ(pairsText(4100000, false), "more than 4,000,000 pairs");
    SelfIntersections undecided;
    undecided.isComplete = false;
    EXPECT_EQ(crossingText(undecided).find("not decided"), 0U);
    EXPECT_FALSE(undecided.isClear());
}

TEST(Nesting, OfBipyramidsInEachOtherIsDecided) {
    const TriangleMesh outer = bipyramid(20000);
    TriangleMesh inner = inAnyOrder(outer);
    for (Vec3& p : inner.points) p = 0.9 * p + turned({2, 1, 0});
    const NestingReport report = checkNesting(inner, outer);
    EXPECT_EQ(report.relation, NestingRelation::Nested);
    // of double cones as high as wide
    EXPECT_NEAR(report.gap.nearest.distanceMm, (5 - std::sqrt(5.0)) / std::numbers::sqrt2, 1e-3);
}

TEST(Nesting, KeepsNoMorePairsThanItNames) {
    const TriangleMesh mesh = crossingAtOnePoint(1000);
    TriangleMesh other = mesh;
    for (Vec3& p : other.points) p = turned(p);
    const NestingReport report = checkNesting(mesh, other, {.maxPairs = 3});
    EXPECT_EQ(report.relation, NestingRelation::Crossing);
    EXPECT_EQ(report.pairs.size(), 3U);
    EXPECT_LE(report.pairs.capacity(), 16U);
    EXPECT_TRUE(report.isComplete);
    const NestingReport all = checkNesting(mesh, other, {.maxPairs = 2000000});
    EXPECT_EQ(std::ssize(all.pairs), report.crossingPairs);
    EXPECT_TRUE(std::equal(report.pairs.begin(), report.pairs.end(), all.pairs.begin()));
}

/// Triangles that overlap in one plane.
TriangleMesh pile(int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, 1);
    TriangleMesh mesh;
    for (int n = 0; n < count; ++n) {
        const double x = place(random), y = place(random);
        for (const Vec3& p : {Vec3{x, y, 0}, Vec3{x + 50, y, 0}, Vec3{x, y + 50, 0}}) {
            mesh.points.push_back(p);
        }
        mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
    }
    return mesh;
}

TEST(Nesting, OfPilesBesideEachOtherIsApart) {
    const TriangleMesh mesh = pile(6000);
    for (const double z : {-0.25, 0.25}) {
        const NestingReport report = checkNesting(translated(mesh, {0, 0, z}), mesh);
        EXPECT_EQ(report.relation, NestingRelation::Apart);
        EXPECT_TRUE(report.areSidesKnown);
        EXPECT_EQ(report.gap.nearest.distanceMm, 0.25);
    }
}

// The piles are open, and rays from points between their boxes' sides pass thousands of triangles.
TEST(Nesting, CountsNoVertexWhoseSideIsNotKnown) {
    TriangleMesh lower = pile(6000), upper = lower;
    for (Vec3& p : lower.points) p = turned(p);
    for (Vec3& p : upper.points) p = turned(p + Vec3{0, 0, 0.25});
    const NestingReport report = checkNesting(lower, upper);
    EXPECT_EQ(report.crossingPairs, 0);
    EXPECT_FALSE(report.areSidesKnown);
    EXPECT_EQ(report.relation, NestingRelation::Unknown);
    EXPECT_LT(report.innerVerticesNotInside, report.innerVertices);
    EXPECT_GE(report.outerVertices, report.outerVerticesInside);
    EXPECT_NEAR(report.gap.nearest.distanceMm, 0.25, 1e-9);
}

TEST(InsideOutPieces, OfShellsInEachOtherAlternate) {
    const TriangleMesh mesh = shells(300, true);
    EXPECT_TRUE(findInsideOutPieces(mesh, checkTopology(mesh))->empty());
    const TriangleMesh wrong = shells(300);
    EXPECT_EQ(findInsideOutPieces(wrong, checkTopology(wrong))->size(), 150U);
}

// Each of 9,000 starts lies beside all triangles.
TEST(InsideOutPieces, OfThousandsOfShellsAreNotDecided) {
    const TriangleMesh mesh = shells(9000);
    EXPECT_FALSE(findInsideOutPieces(mesh, checkTopology(mesh)).has_value());
}

TEST(NearestPlaces, AreThoseOfTheTreeWhereNeedlesMeet) {
    const TriangleMesh mesh = bipyramid(40000);
    const AabbTree tree(mesh);
    std::vector<Vec3> points;
    for (int n = 0; n < 2000; ++n) points.push_back(turned(onCircle(n * 0.618, 5 + n * 0.02, 3)));
    std::vector<double> squared(points.size());
    const RoughDistances rough = findNearestPlaces(
        mesh, tree, std::ssize(points), [&](std::int64_t n) { return points[n]; },
        [&](std::int64_t n, const ClosestPoint& nearest) {
            squared[n] = nearest.squaredDistanceMm2;
        });
    EXPECT_EQ(rough.rough, 0);
    EXPECT_EQ(rough.open, 0);
    for (std::size_t n = 0; n < points.size(); n += 50) {
        EXPECT_NEAR(std::sqrt(squared[n]),
                    std::sqrt(tree.closestPoint(points[n]).squaredDistanceMm2), 1e-9);
    }
}

TEST(NearestPlaces, OfPointsAtTheCentreOfASphereAreWithinAHundredth) {
    const TriangleMesh mesh = icosphere(6, {}, 50);
    const AabbTree tree(mesh);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1e-6, 1e-6);
    std::vector<Vec3> points;
    for (int n = 0; n < 4000; ++n) points.push_back({place(random), place(random), place(random)});
    std::vector<double> squared(points.size());
    const RoughDistances rough = findNearestPlaces(
        mesh, tree, std::ssize(points), [&](std::int64_t n) { return points[n]; },
        [&](std::int64_t n, const ClosestPoint& nearest) {
            squared[n] = nearest.squaredDistanceMm2;
        });
    EXPECT_GT(rough.rough, 3000);
    EXPECT_EQ(rough.open, 0);
    for (std::size_t n = 0; n < points.size(); n += 40) {
        const double exact = std::sqrt(tree.closestPoint(points[n]).squaredDistanceMm2);
        EXPECT_GE(std::sqrt(squared[n]), exact);
        EXPECT_LE(std::sqrt(squared[n]), exact / SearchEffort::kRough);
    }
}

// No box tells triangles apart: each search ends with its budget.
TEST(NearestPlaces, OfTrianglesThatAllCrossAreThoseOfSomeAndCounted) {
    constexpr int kCount = 6000;
    const TriangleMesh mesh = crossingAtOnePoint(kCount);
    const AabbTree tree(mesh);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1, 1);
    std::vector<Vec3> points;
    for (int n = 0; n < 4000; ++n) points.push_back({place(random), place(random), place(random)});
    std::vector<double> squared(points.size());
    const RoughDistances rough = findNearestPlaces(
        mesh, tree, std::ssize(points), [&](std::int64_t n) { return points[n]; },
        [&](std::int64_t n, const ClosestPoint& nearest) {
            squared[n] = nearest.squaredDistanceMm2;
        });
    EXPECT_GT(rough.open, 3000);
    for (std::size_t n = 0; n < points.size(); n += 40) {
        const double exact = std::sqrt(tree.closestPoint(points[n]).squaredDistanceMm2);
        EXPECT_GE(std::sqrt(squared[n]), exact);
    }
}

TEST(NearestPlaces, OfTrianglesThatAllCrossSomeAreExactAndStandForOthers) {
    constexpr int kCount = 6000;
    const TriangleMesh mesh = crossingAtOnePoint(kCount);
    const AabbTree tree(mesh);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1, 1);
    std::vector<Vec3> points;
    for (int n = 0; n < 9000; ++n) points.push_back({place(random), place(random), place(random)});
    const auto search = [&](std::vector<double>& squared) {
        squared.assign(points.size(), -1);
        std::vector<StandIn> standIns;
        const RoughDistances rough = findNearestPlaces(
            mesh, tree, std::ssize(points), [&](std::int64_t n) { return points[n]; },
            [&](std::int64_t n, const ClosestPoint& nearest) {
                squared[n] = nearest.squaredDistanceMm2;
            },
            true, &standIns);
        EXPECT_EQ(rough.open, 0);
        return standIns;
    };
    std::vector<double> squared, again;
    const std::vector<StandIn> standIns = search(squared);
    EXPECT_GT(standIns.size(), points.size() / 2);
    std::vector<bool> isLeftOut(points.size());
    for (const auto& [point, like] : standIns) isLeftOut[point] = true;
    for (const auto& [point, like] : standIns) {
        EXPECT_FALSE(isLeftOut[like]);
        EXPECT_LE(std::abs(like - point), 256);  // evenly spread
    }
    std::int64_t looks = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (isLeftOut[n]) continue;
        ++looks;
        const double exact = std::sqrt(tree.closestPoint(points[n]).squaredDistanceMm2);
        EXPECT_GE(std::sqrt(squared[n]), exact);
        EXPECT_LE(std::sqrt(squared[n]), exact / SearchEffort::kRough);
    }
    EXPECT_GT(looks, 100);

    const ThreadLimitGuard one(1);
    const std::vector<StandIn> others = search(again);
    EXPECT_EQ(again, squared);
    EXPECT_EQ(others.size(), standIns.size());
}

// More points than the budget of all allows cost no more than it: the table has 400,000 for a
// direction of a comparison, and each vertex.
TEST(NearestPlaces, OfManyPointsAmongTrianglesThatAllCrossAreWithinOneBudget) {
    constexpr std::int64_t kTriangles = 2000, kPoints = 400'000, kMostLooks = 24'000'000;
    const TriangleMesh mesh = crossingAtOnePoint(kTriangles);
    const AabbTree tree(mesh);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1, 1);
    std::vector<Vec3> points(kPoints);
    for (Vec3& p : points) p = {place(random), place(random), place(random)};
    std::vector<StandIn> standIns;
    findNearestPlaces(
        mesh, tree, kPoints, [&](std::int64_t n) { return points[n]; },
        [](std::int64_t, const ClosestPoint&) {}, true, &standIns);
    const std::int64_t measured = kPoints - std::ssize(standIns);
    EXPECT_LE(measured * kTriangles, kMostLooks);  // each has all triangles looked at
    EXPECT_GT(measured, 5'000);
}

TEST(SurfaceDistance, OfTrianglesThatAllCrossIsThatOfSomeSamples) {
    const TriangleMesh mesh = crossingAtOnePoint(3000);
    // from the mesh to itself rough distances were as large as the mesh
    const DistanceStatistics own = surfaceDistance(mesh, mesh, {.isSymmetric = false}).combined;
    EXPECT_LE(own.maxMm, 1e-11);

    constexpr std::int64_t kSamples = 20000;
    TriangleMesh other = mesh;
    for (Vec3& p : other.points) p = p + Vec3{0.01, 0.02, 0.03};
    const DistanceStatistics found =
        surfaceDistance(mesh, other, {.samples = kSamples, .isSymmetric = false}).combined;
    EXPECT_GT(found.leftOut, kSamples / 2);
    EXPECT_EQ(found.measured(), kSamples - found.leftOut);
    EXPECT_LE(found.maxMm, norm(Vec3{0.01, 0.02, 0.03}) + 1e-12);
    // random points, each by the tree
    const AabbTree tree(other);
    double sum = 0;
    constexpr int kPoints = 4000;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> place(0, 1);
    std::vector<double> upTo;
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
        area += norm(areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]])) / 2;
        upTo.push_back(area);
    }
    for (int n = 0; n < kPoints; ++n) {
        const auto at = std::lower_bound(upTo.begin(), upTo.end(), place(random) * area);
        const Corners c = cornersOf(mesh, at - upTo.begin());
        double u = place(random), v = place(random);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        sum += std::sqrt(
            tree.closestPoint(c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0])).squaredDistanceMm2);
    }
    // two standard errors of this one, and as many samples or more of the other
    EXPECT_NEAR(found.meanMm, sum / kPoints, 3 * found.meanErrorMm);
    EXPECT_LE(found.meanErrorMm, 0.1 * found.meanMm);
}

}  // namespace adaptiso::testing
