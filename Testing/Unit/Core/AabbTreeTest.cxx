#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

double randomReal(double low, double high, std::uint64_t& state) {
    return low + (high - low) * static_cast<double>(testing::nextRandom(state) >> 11) * 0x1p-53;
}

Vec3 randomPoint(double low, double high, std::uint64_t& state) {
    const double x = randomReal(low, high, state), y = randomReal(low, high, state);
    return {x, y, randomReal(low, high, state)};
}

TriangleMesh randomSoup(int triangles, std::uint64_t seed) {
    TriangleMesh mesh;
    for (int n = 0; n < triangles; ++n) {
        const Vec3 centre = randomPoint(-10, 10, seed);
        const auto first = static_cast<VertexId>(mesh.points.size());
        for (int corner = 0; corner < 3; ++corner) {
            mesh.points.push_back(centre + randomPoint(-1, 1, seed));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

/// The distance by looking at every triangle.
double bruteForceDistance2(const TriangleMesh& mesh, const Vec3& p) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 q = closestPointOnTriangle(p, mesh.points[a], mesh.points[b], mesh.points[c]);
        best = std::min(best, squaredNorm(p - q));
    }
    return best;
}

TEST(ClosestPointOnTriangle, FindsCornersSidesAndFace) {
    const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
    EXPECT_EQ(closestPointOnTriangle({-1, -2, 3}, a, b, c), a);
    EXPECT_EQ(closestPointOnTriangle({6, -1, 3}, a, b, c), b);
    EXPECT_EQ(closestPointOnTriangle({-1, 6, 3}, a, b, c), c);
    EXPECT_EQ(closestPointOnTriangle({1, -2, 3}, a, b, c), (Vec3{1, 0, 0}));
    EXPECT_EQ(closestPointOnTriangle({-2, 3, 3}, a, b, c), (Vec3{0, 3, 0}));
    EXPECT_EQ(closestPointOnTriangle({3, 3, 1}, a, b, c), (Vec3{2, 2, 0}));
    EXPECT_EQ(closestPointOnTriangle({1, 1, -5}, a, b, c), (Vec3{1, 1, 0}));
}

TEST(ClosestPointOnTriangle, TakesTrianglesWithoutAreaAsSegments) {
    const Vec3 a{0, 0, 0}, b{4, 0, 0};
    for (const Vec3& middle : {a, b, Vec3{1, 0, 0}}) {
        EXPECT_EQ(closestPointOnTriangle({3, 2, 0}, a, middle, b), (Vec3{3, 0, 0}));
        EXPECT_EQ(closestPointOnTriangle({3, 2, 0}, middle, a, b), (Vec3{3, 0, 0}));
        EXPECT_EQ(closestPointOnTriangle({3, 2, 0}, a, b, middle), (Vec3{3, 0, 0}));
    }
    EXPECT_EQ(closestPointOnTriangle({3, 2, 0}, a, a, a), a);
}

TEST(ClosestPointOnTriangle, NoPointOfTheTriangleIsNearer) {
    std::uint64_t state = 1;
    for (int n = 0; n < 300; ++n) {
        const Vec3 a = randomPoint(-1, 1, state), b = randomPoint(-1, 1, state),
                   c = randomPoint(-1, 1, state), p = randomPoint(-2, 2, state);
        const double found = norm(p - closestPointOnTriangle(p, a, b, c));
        double sampled = std::numeric_limits<double>::infinity();
        constexpr int kSteps = 40;
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; i + j <= kSteps; ++j) {
                const Vec3 q = a + double(i) / kSteps * (b - a) + double(j) / kSteps * (c - a);
                sampled = std::min(sampled, norm(p - q));
            }
        }
        EXPECT_LE(found, sampled + 1e-14);  // rounding of coordinates up to 2
        // Sides are at most 2 sqrt 3 long; the lattice has a point within 1 / 40 of that.
        EXPECT_GE(found, sampled - 3.5 / kSteps);
    }
}

TEST(AabbTree, FindsTheNearestOfAllTriangles) {
    for (const int triangles : {1, 2, 3, 4, 5, 7, 8, 9, 63, 64, 65, 1000}) {
        const TriangleMesh soup = randomSoup(triangles, 7);
        const AabbTree tree(soup);
        EXPECT_EQ(tree.triangleCount(), triangles);
        std::uint64_t state = 3;
        for (int n = 0; n < 200; ++n) {
            const Vec3 p = randomPoint(-14, 14, state);
            const ClosestPoint found = tree.closestPoint(p);
            ASSERT_EQ(found.squaredDistanceMm2, bruteForceDistance2(soup, p));
            ASSERT_EQ(found.squaredDistanceMm2, squaredNorm(p - found.pointMm));
            ASSERT_EQ(tree.closestPoint(p, n % triangles).squaredDistanceMm2,
                      found.squaredDistanceMm2);
        }
    }
}

TEST(AabbTree, VisitsEveryTriangleWhoseBoxOverlapsOnce) {
    const TriangleMesh soup = randomSoup(500, 8);
    const AabbTree tree(soup);
    std::uint64_t state = 4;
    for (int n = 0; n < 100; ++n) {
        const Vec3 corner = randomPoint(-12, 12, state);
        const BoundingBox box{corner, corner + randomPoint(0, 6, state)};
        std::vector<std::int64_t> found, truth;
        tree.forEachOverlap(box, [&](std::int64_t triangle) { found.push_back(triangle); });
        std::sort(found.begin(), found.end());
        for (std::int64_t t = 0; t < 500; ++t) {
            if (box.overlaps(tree.triangleBox(t))) truth.push_back(t);
        }
        ASSERT_EQ(found, truth);
    }
}

TEST(AabbTree, VisitsEveryTriangleWithinReachOnce) {
    const TriangleMesh soup = randomSoup(500, 8);
    const AabbTree tree(soup);
    std::uint64_t state = 4;
    for (int n = 0; n < 100; ++n) {
        const Vec3 corner = randomPoint(-12, 12, state);
        const BoundingBox box{corner, corner + randomPoint(0, 3, state)};
        const double reach2 = n * 0.05;
        std::vector<int> visits(500);
        double shrinking = std::numeric_limits<double>::infinity(), nearest = shrinking;
        tree.forEachNear(
            box, [&] { return reach2; }, [&](std::int64_t t) { ++visits[t]; });
        tree.forEachNear(
            box, [&] { return shrinking; },
            [&](std::int64_t t) {
                shrinking = std::min(shrinking, squaredDistance(box, tree.triangleBox(t)));
            });
        for (std::int64_t t = 0; t < 500; ++t) {
            const double distance2 = squaredDistance(box, tree.triangleBox(t));
            nearest = std::min(nearest, distance2);
            EXPECT_LE(visits[t], 1);
            EXPECT_GE(visits[t], distance2 <= reach2 ? 1 : 0);
        }
        EXPECT_EQ(shrinking, nearest);
    }
}

TEST(AabbTree, OfAnEmptyMeshFindsNothing) {
    const TriangleMesh empty;
    const AabbTree tree(empty);
    EXPECT_EQ(tree.closestPoint({0, 0, 0}).triangle, -1);
    tree.forEachOverlap({{-1, -1, -1}, {1, 1, 1}}, [](std::int64_t) { ADD_FAILURE(); });
    tree.forEachNear(
        {}, [] { return 1.0; }, [](std::int64_t) { ADD_FAILURE(); });
}

TEST(AabbTree, LeavesTrianglesWithNanOut) {
    const TriangleMesh mesh = testing::withNanCoordinate(testing::cubeMesh());
    const AabbTree tree(mesh);
    EXPECT_LT(tree.triangleCount(), 12);
    EXPECT_GT(tree.triangleCount(), 0);
    EXPECT_EQ(tree.closestPoint({1, 1, 3}).squaredDistanceMm2, 4);
}

TEST(AabbTree, RefusesTrianglesThatNameNoPoint) {
    const TriangleMesh mesh = testing::withIndexOutOfRange(testing::cubeMesh());
    EXPECT_THROW(AabbTree{mesh}, InvalidInput);
}

TEST(AabbTree, HoldsManyTrianglesInOnePlace) {
    TriangleMesh heap = testing::cubeMesh();
    for (int n = 0; n < 5; ++n) {  // 12 * 2^5 triangles, every centre 32 times
        heap.triangles.insert(heap.triangles.end(), heap.triangles.begin(), heap.triangles.end());
    }
    const AabbTree tree(heap);
    EXPECT_EQ(tree.closestPoint({0.5, 0.5, 3}).squaredDistanceMm2, 4);
}

TEST(AabbTree, LeavesHoldTheirTrianglesByNumber) {
    const TriangleMesh mesh = testing::icosphere(3);
    const AabbTree tree(mesh);
    for (std::size_t first = 0; first < mesh.triangles.size(); first += 4) {
        const auto leaf = tree.triangles().subspan(first, 4);  // 1280 triangles: all are full
        EXPECT_TRUE(std::is_sorted(leaf.begin(), leaf.end())) << first;
    }
}

TEST(AabbTree, AnswersAreTheSameWhateverTheNumberOfThreads) {
    const TriangleMesh mesh = testing::icosphere(5);  // 20480 triangles: built by several tasks
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        const AabbTree tree(mesh);
        std::vector<std::int64_t> order;
        tree.forEachOverlap(boundingBox(mesh), [&](std::int64_t t) { order.push_back(t); });
        return order;
    };
    const std::vector<std::int64_t> one = run(1);
    EXPECT_EQ(one.size(), mesh.triangles.size());
    EXPECT_EQ(one, run(2));
}

}  // namespace
}  // namespace adaptiso
