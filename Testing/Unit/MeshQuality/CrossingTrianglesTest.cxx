#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "ExactCrossing.h"
#include "Support/Meshes.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::testing {
namespace {

/// By a look at all pairs; nothing where four points lie in one plane, or a triangle comes twice.
std::optional<std::vector<std::int64_t>> crossingByBruteForce(const IntegerSoup& soup) {
    std::set<std::int64_t> crossing;
    const int count = static_cast<int>(soup.triangles.size());
    for (int s = 0; s < count; ++s) {
        for (int t = s + 1; t < count; ++t) {
            const std::set<int> points = [&] {
                std::set<int> all(soup.triangles[s].begin(), soup.triangles[s].end());
                all.insert(soup.triangles[t].begin(), soup.triangles[t].end());
                return all;
            }();
            if (points.size() == 3) return {};
            const std::optional<bool> cross = soup.cross(s, t);
            if (!cross) return {};
            if (*cross) crossing.insert({s, t});
        }
    }
    return std::vector<std::int64_t>(crossing.begin(), crossing.end());
}

/// The same without pairs of different cells.
std::optional<std::vector<std::int64_t>> crossingByBruteForce(
    const IntegerSoup& soup, const std::vector<std::uint64_t>& cells) {
    std::set<std::int64_t> crossing;
    const int count = static_cast<int>(soup.triangles.size());
    for (int s = 0; s < count; ++s) {
        for (int t = s + 1; t < count; ++t) {
            const std::optional<bool> cross = soup.cross(s, t);
            if (!cross) return {};
            const bool isTested =
                cells[s] == cells[t] || cells[s] == kNoCell || cells[t] == kNoCell;
            if (*cross && isTested) crossing.insert({s, t});
        }
    }
    return std::vector<std::int64_t>(crossing.begin(), crossing.end());
}

}  // namespace

TEST(CrossingTriangles, FindsTrianglesThatCross) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(crossingTriangles(mesh), (std::vector<std::int64_t>{0, 1}));
    mesh.points[3] = {1, 1, 0.5};
    EXPECT_TRUE(crossingTriangles(mesh).empty());
    EXPECT_TRUE(crossingTriangles(TriangleMesh{}).empty());
}

TEST(CrossingTriangles, LeavesOutPairsOfDifferentCells) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    const std::vector<std::int64_t> both{0, 1}, none;
    using Cells = std::vector<std::uint64_t>;
    EXPECT_EQ(crossingTriangles(mesh, Cells{3, 4}), none);
    EXPECT_EQ(crossingTriangles(mesh, Cells{3, 3}), both);
    EXPECT_EQ(crossingTriangles(mesh, Cells{3, kNoCell}), both);
    EXPECT_EQ(crossingTriangles(mesh, Cells{kNoCell, 3}), both);
    EXPECT_EQ(crossingTriangles(mesh, Cells{kNoCell, kNoCell}), both);
    EXPECT_EQ(crossingTriangles(mesh, Cells{}), both);
}

// Cells come in any order, and again after others.
TEST(CrossingTriangles, FindsExactlyWhatCrossesInCellsOfSoups) {
    std::mt19937 random(6);
    std::size_t compared = 0, found = 0, without = 0;
    for (int n = 0; n < 600; ++n) {
        const IntegerSoup soup = randomSoup(random, 8 + n % 40, 12, 1000);
        const std::optional<std::vector<std::int64_t>> all = crossingByBruteForce(soup);
        if (!all) continue;
        std::vector<std::uint64_t> cells(soup.triangles.size());
        for (std::uint64_t& cell : cells) {
            cell = random() % 3 == 0 ? kNoCell : random() % (1 + n % 4);
        }
        const auto expected = crossingByBruteForce(soup, cells);
        ASSERT_EQ(crossingTriangles(soup.mesh(), cells), *expected) << n;
        ++compared;
        found += expected->size();
        without += all->size() - expected->size();
    }
    EXPECT_GT(compared, 200U);
    EXPECT_GT(found, 100U);
    EXPECT_GT(without, 100U);
}

// Few points: most triangles share corners, and edges.
TEST(CrossingTriangles, FindsExactlyWhatCrossesInSoups) {
    std::mt19937 random(4);
    int compared = 0;
    std::size_t found = 0, clear = 0;
    for (int n = 0; n < 400; ++n) {
        const IntegerSoup soup = randomSoup(random, 8 + n % 40, 12, 1000);
        const auto expected = crossingByBruteForce(soup);
        if (!expected) continue;
        ++compared;
        found += expected->size();
        clear += 12 - expected->size();
        ASSERT_EQ(crossingTriangles(soup.mesh()), *expected) << n;
    }
    EXPECT_GT(compared, 200);
    EXPECT_GT(found, 100U);
    EXPECT_GT(clear, 100U);
}

// Larger meshes, whose vertices have fans that are proved at once.
TEST(CrossingTriangles, FindsAllTrianglesOfSpheresThatCross) {
    EXPECT_TRUE(crossingTriangles(icosphere(3)).empty());
    EXPECT_TRUE(crossingTriangles(torusMesh(20, 12, 3, 1)).empty());
    const TriangleMesh mesh = crossingSpheres(2);
    std::set<std::int64_t> expected;
    std::int64_t pairs = 0;
    for (std::int64_t a = 0; a < std::ssize(mesh.triangles); ++a) {
        for (std::int64_t b = 0; b < a; ++b) {
            if (!trianglesCross(cornersOf(mesh, a), cornersOf(mesh, b))) continue;
            expected.insert({a, b});
            ++pairs;
        }
    }
    EXPECT_EQ(findSelfIntersections(mesh).pairCount, pairs);
    EXPECT_GT(expected.size(), 20U);
    EXPECT_EQ(crossingTriangles(mesh), std::vector<std::int64_t>(expected.begin(), expected.end()));
}

TEST(CrossingTriangles, FindsAFanThatIsFoldedOver) {
    // eight sectors around the origin, of which one vertex of the ring is taken across the next
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}};
    for (int i = 0; i < 8; ++i) {
        const double angle = M_PI / 4 * i;
        mesh.points.push_back({std::cos(angle), std::sin(angle), 0.1});
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % 8});
    }
    EXPECT_TRUE(crossingTriangles(mesh).empty());
    mesh.points[1] = {std::cos(1.0), std::sin(1.0), 0.05};
    mesh.points[8].z = 0.6;  // so that the sector between them passes through the one behind it
    EXPECT_FALSE(crossingTriangles(mesh).empty());
}

TEST(CrossingTriangles, FindsATriangleThatComesTwice) {
    EXPECT_EQ(crossingTriangles(withDuplicateTriangle(icosphere(1))).size(), 2U);
}

}  // namespace adaptiso::testing
