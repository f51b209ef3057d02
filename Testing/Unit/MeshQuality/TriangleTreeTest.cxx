#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "Support/RandomPoints.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso::testing {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Triangles of all sizes, everywhere.
struct Soup {
    std::vector<Vec3> points;
    std::vector<TriangleView::Triangle> triangles;

    TriangleView view() const { return {points, triangles}; }
    BoundingBox boxOf(std::size_t t) const { return adaptiso::boxOf(view().cornersOf(t)); }
};

Soup randomSoup(std::mt19937& random, std::uint32_t count) {
    Soup soup;
    for (std::uint32_t t = 0; t < count; ++t) {
        const Vec3 middle = randomPoint(random, 10);
        const double size = t % 7 == 0 ? 3 : 0.3;
        for (int c = 0; c < 3; ++c) soup.points.push_back(middle + randomPoint(random, size));
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return soup;
}

std::set<Pair> pairsOf(const TriangleTree& tree, const TriangleView& view, std::int64_t piece) {
    const TriangleTree::Pairs pairs(tree, view);
    std::set<Pair> found;
    for (std::int64_t begin = 0; begin < tree.leafCount(); begin += piece) {
        constexpr auto kAll = std::numeric_limits<std::int64_t>::max();
        EXPECT_TRUE(pairs.forEach(begin, std::min(begin + piece, tree.leafCount()), kAll,
                                  [&](std::uint32_t a, std::uint32_t b) {
                                      EXPECT_LT(a, b);
                                      EXPECT_TRUE(found.insert({a, b}).second) << "told twice";
                                  }));
    }
    return found;
}

}  // namespace

TEST(TriangleTree, IsEmptyWithoutTriangles) {
    const TriangleTree tree{TriangleView{}};
    EXPECT_EQ(tree.leafCount(), 0);
    EXPECT_EQ(tree.squaredDistance({}, {}), std::numeric_limits<double>::infinity());
    tree.forEachOverlap({{-1, -1, -1}, {1, 1, 1}}, {}, [](std::uint32_t) { FAIL(); });
}

TEST(TriangleTree, FindsAllThatOverlapABox) {
    std::mt19937 random(1);
    for (const std::uint32_t count : {1U, 8U, 9U, 1000U}) {
        const Soup soup = randomSoup(random, count);
        const TriangleTree tree(soup.view());
        for (int n = 0; n < 50; ++n) {
            BoundingBox box{randomPoint(random, 10), {}};
            box.maximum = box.minimum;
            box.widen(n % 2 == 0 ? 0.5 : 4);
            std::set<std::uint32_t> found;
            tree.forEachOverlap(box, soup.view(), [&](std::uint32_t t) {
                EXPECT_TRUE(found.insert(t).second) << "told twice";
            });
            for (std::uint32_t t = 0; t < count; ++t) {
                EXPECT_EQ(found.contains(t), soup.boxOf(t).overlaps(box));
            }
        }
    }
}

TEST(TriangleTree, MakesNoPairOfOneTriangle) {
    std::mt19937 random(5);
    for (std::uint32_t count = 1; count < 20; ++count) {
        const Soup soup = randomSoup(random, count);
        for (const auto& [a, b] : pairsOf(TriangleTree(soup.view()), soup.view(), 1)) {
            EXPECT_TRUE(soup.boxOf(a).overlaps(soup.boxOf(b)));
        }
    }
}

TEST(TriangleTree, TellsEachPairOnceHoweverItsLeavesAreDealtOut) {
    std::mt19937 random(2);
    const Soup soup = randomSoup(random, 500);
    const TriangleTree tree(soup.view());
    const std::set<Pair> found = pairsOf(tree, soup.view(), 1);
    EXPECT_EQ(pairsOf(tree, soup.view(), 7), found);
    EXPECT_EQ(pairsOf(tree, soup.view(), tree.leafCount()), found);
    std::size_t overlapping = 0;
    for (std::uint32_t a = 0; a < 500; ++a) {
        for (std::uint32_t b = a + 1; b < 500; ++b) {
            if (!soup.boxOf(a).overlaps(soup.boxOf(b))) continue;
            ++overlapping;
            EXPECT_TRUE(found.contains({a, b}));
        }
    }
    EXPECT_GT(overlapping, 100U);
    EXPECT_LE(found.size(), overlapping + 5);  // single precision
}

TEST(TriangleTree, MeasuresAsTheTreeOfMeshesDoes) {
    std::mt19937 random(3);
    const Soup soup = randomSoup(random, 300);
    TriangleMesh mesh;
    mesh.points = soup.points;
    for (const auto& [a, b, c] : soup.triangles) mesh.triangles.push_back({a, b, c});
    const TriangleTree tree(soup.view());
    const AabbTree expected(mesh);
    for (int n = 0; n < 200; ++n) {
        const Vec3 p = randomPoint(random, 15);
        EXPECT_EQ(tree.squaredDistance(p, soup.view()),
                  expected.closestPoint(p).squaredDistanceMm2);
    }
}

TEST(TriangleTree, LosesNothingWhereNumbersAreTooLargeForSinglePrecision) {
    std::mt19937 random(4);
    Soup soup = randomSoup(random, 100);
    soup.points[0] = {1e300, -1e300, 1e300};
    soup.points[299] = soup.points[0] + Vec3{1e290, 1e290, 1e290};
    const TriangleTree tree(soup.view());
    std::set<std::uint32_t> found;
    tree.forEachOverlap({{-1e301, -1e301, -1e301}, {1e301, 1e301, 1e301}}, soup.view(),
                        [&](std::uint32_t t) { found.insert(t); });
    EXPECT_EQ(found.size(), 100U);
    EXPECT_TRUE(pairsOf(tree, soup.view(), 3).contains({0, 99}));
}

}  // namespace adaptiso::testing
