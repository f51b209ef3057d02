#include <gtest/gtest.h>

#include <map>
#include <set>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/detail/PlanarTriangulation.h"

namespace adaptiso::detail {
namespace {

using Points = std::vector<std::array<std::int64_t, 2>>;

void addLoop(const Points& loop, std::vector<PlanarCorner>& corners) {
    const std::uint32_t first = static_cast<std::uint32_t>(corners.size());
    const std::uint32_t n = static_cast<std::uint32_t>(loop.size());
    for (std::uint32_t i = 0; i < n; ++i) {
        corners.push_back({loop[i][0], loop[i][1], first + (i + n - 1) % n, first + (i + 1) % n});
    }
}

std::int64_t area2(const std::vector<PlanarCorner>& corners) {
    std::int64_t sum = 0;
    for (const PlanarCorner& c : corners) {
        sum += c.u * corners[c.next].v - c.v * corners[c.next].u;
    }
    return sum;
}

/// Triangles of positive area that fill the region, with the loops as their free edges.
void expectFilled(const std::vector<PlanarCorner>& corners, std::size_t expectedTriangles) {
    std::vector<LocalTriangle> triangles;
    PlanarTriangulator().triangulate(corners, triangles);
    EXPECT_EQ(triangles.size(), expectedTriangles);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::int64_t sum = 0;
    for (const auto& [a, b, c] : triangles) {
        const auto &p = corners[a], &q = corners[b], &r = corners[c];
        const std::int64_t area = (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
        EXPECT_GT(area, 0);
        sum += area;
        ++edges[{a, b}];
        ++edges[{b, c}];
        ++edges[{c, a}];
    }
    EXPECT_EQ(sum, area2(corners));
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        EXPECT_EQ((edges[{i, corners[i].next}]), 1);
        EXPECT_EQ(edges.count({corners[i].next, i}), 0u);
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 1);
}

/// The boundary loops of the set cells of a grid, cells left of every edge; corners on straight
/// runs are kept. Where two cells touch at a corner the loops pass it twice.
std::vector<PlanarCorner> boundaryOf(const std::vector<std::vector<bool>>& cell) {
    const int h = static_cast<int>(cell.size()), w = static_cast<int>(cell[0].size());
    const auto isSet = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < w && y < h &&
               cell[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
    };
    // directed unit edges by start; at a touching corner the left turn keeps the cells apart
    const int dx[] = {1, 0, -1, 0}, dy[] = {0, 1, 0, -1};
    std::set<std::array<int, 3>> edges;  // x, y, direction
    for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
            if (!isSet(x, y)) continue;
            if (!isSet(x, y - 1)) edges.insert({x, y, 0});
            if (!isSet(x + 1, y)) edges.insert({x + 1, y, 1});
            if (!isSet(x, y + 1)) edges.insert({x + 1, y + 1, 2});
            if (!isSet(x - 1, y)) edges.insert({x, y + 1, 3});
        }
    }
    std::vector<PlanarCorner> corners;
    while (!edges.empty()) {
        std::array<int, 3> edge = *edges.begin();
        Points loop;
        while (edges.erase(edge) == 1) {
            loop.push_back({edge[0], edge[1]});
            const int x = edge[0] + dx[edge[2]], y = edge[1] + dy[edge[2]];
            for (const int turn : {1, 0, 3}) {
                const std::array<int, 3> next{x, y, (edge[2] + turn) % 4};
                if (edges.count(next)) {
                    edge = next;
                    break;
                }
            }
        }
        addLoop(loop, corners);
    }
    return corners;
}

}  // namespace

TEST(PlanarTriangulator, FillsASquareWithCornersOnItsSides) {
    std::vector<PlanarCorner> corners;
    addLoop({{0, 0}, {1, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 4}, {0, 4}, {0, 3}}, corners);
    expectFilled(corners, 6);
}

TEST(PlanarTriangulator, FillsASquareWithHoles) {
    std::vector<PlanarCorner> corners;
    addLoop({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, corners);
    addLoop({{1, 1}, {1, 3}, {3, 3}, {3, 1}}, corners);
    addLoop({{6, 5}, {5, 7}, {8, 6}}, corners);
    expectFilled(corners, 4 + 4 + 3 + 2 * 2 - 2);
}

TEST(PlanarTriangulator, FillsPiecesAndHolesThatTouchAtCorners) {
    std::vector<PlanarCorner> corners;
    // a square with a hole that hangs on its corner (0, 4): the loop passes that corner twice
    addLoop({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {1, 1}, {0, 4}}, corners);
    addLoop({{4, 4}, {8, 4}, {8, 8}, {4, 8}}, corners);
    expectFilled(corners, 5 + 2);
}

TEST(PlanarTriangulator, FillsRandomRegionsOfCells) {
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
        std::uint64_t state = seed;
        const std::size_t w = 1 + testing::nextRandom(state) % 12,
                          h = 1 + testing::nextRandom(state) % 12;
        const std::uint64_t density = 2 + seed % 5;
        std::vector<std::vector<bool>> cell(h, std::vector<bool>(w));
        for (auto& row : cell) {
            for (std::size_t x = 0; x < w; ++x) row[x] = testing::nextRandom(state) % density != 0;
        }
        const std::vector<PlanarCorner> corners = boundaryOf(cell);
        if (corners.empty()) continue;
        std::vector<LocalTriangle> triangles;
        ASSERT_NO_THROW(PlanarTriangulator().triangulate(corners, triangles)) << "seed " << seed;
        expectFilled(corners, triangles.size());
        if (::testing::Test::HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST(PlanarTriangulator, RefusesLoopsThatBoundNothing) {
    std::vector<PlanarCorner> corners;
    addLoop({{0, 0}, {0, 4}, {4, 4}, {4, 0}}, corners);  // a hole in nothing
    std::vector<LocalTriangle> triangles;
    EXPECT_THROW(PlanarTriangulator().triangulate(corners, triangles), InternalError);
}

}  // namespace adaptiso::detail
