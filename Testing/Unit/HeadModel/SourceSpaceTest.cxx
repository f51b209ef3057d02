#include <gtest/gtest.h>

#include "Support/Meshes.h"
#include "adaptiso/HeadModel/SourceSpace.h"

namespace adaptiso {
namespace {

using testing::icosphere;

const TriangleMesh kSkull = icosphere(3, {}, 80);  // 642 vertices, edges of 10.6 to 12.7 mm
constexpr double kShortestMm = 10.5, kLongestMm = 12.8;
constexpr double kChordMm = 0.35;  // 7.3^2 / 160: the middle of a face below the sphere

TEST(SourceSpace, ACountOfVerticesIsSpreadEvenlyOverEveryPiece) {
    TriangleMesh cortex = icosphere(4, {-40, 0, 0}, 30);
    const TriangleMesh other = icosphere(4, {40, 0, 0}, 30);
    const auto first = static_cast<VertexId>(cortex.points.size());
    cortex.points.insert(cortex.points.end(), other.points.begin(), other.points.end());
    cortex.points.push_back({0, 0, 0});  // of no triangle
    for (const auto& [a, b, c] : other.triangles) {
        cortex.triangles.push_back({first + a, first + b, first + c});
    }
    const SourceSpace sources = surfaceSources(cortex, 200);
    ASSERT_EQ(sources.used.size(), 200u);
    double nearest = 1000;
    std::int64_t right = 0;
    for (std::size_t a = 0; a < 200; ++a) {
        right += sources.used[a] >= first ? 1 : 0;
        for (std::size_t b = a + 1; b < 200; ++b) {
            ASSERT_LT(sources.used[a], sources.used[b]);
            nearest = std::min(
                nearest, norm(cortex.points[sources.used[a]] - cortex.points[sources.used[b]]));
        }
    }
    EXPECT_NEAR(static_cast<double>(right), 100, 5);
    // hexagons of a 100th of a ball's area are 11.4 mm apart; the greedy choice reaches half at
    // least
    EXPECT_GE(nearest, 5.7);
    EXPECT_EQ(surfaceSources(cortex, 1'000'000).used.size(), cortex.points.size() - 1);
}

TEST(SourceSpace, NormalsOfASurfaceInsideOutPointOutward) {
    TriangleMesh cortex = icosphere(3, {}, 30);
    flipOrientation(cortex);
    const SourceSpace sources = surfaceSources(cortex, 10);
    for (const std::int64_t n : sources.used) {
        ASSERT_EQ(sources.orientations(n).size(), 1u);
        EXPECT_GT(dot(sources.orientations(n)[0], normalized(cortex.points[n])), 0.999);
    }
}

TEST(SourceSpace, AnOpenSurfaceKeepsItsOrientation) {
    TriangleMesh half = icosphere(3, {}, 30);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.points[t[0]].z + half.points[t[1]].z + half.points[t[2]].z < 0;
    });
    for (const double side : {1, -1}) {
        const SourceSpace sources = surfaceSources(half, 10);
        EXPECT_TRUE(sources.isOpen);
        for (const std::int64_t n : sources.used) {
            EXPECT_GT(side * dot(sources.orientations(n)[0], normalized(half.points[n])),
                      0.9);  // at the rim triangles lie on one side alone
        }
        flipOrientation(half);
    }
    EXPECT_FALSE(surfaceSources(kSkull, 10).isOpen);
}

TEST(SourceSpace, SourcesNearerThanAnEdgeMoveInwardsAndFarOnesStay) {
    TriangleMesh cortex = icosphere(3, {}, 60);
    for (Vec3& p : cortex.points) {
        if (p.x > 0) p = 78 / norm(p) * p;  // 2 mm below the skull
    }
    const TriangleMesh before = cortex;
    SourceSpace sources = surfaceSources(cortex, 1'000'000);
    const SourceMoves moves = keepWithin(sources, kSkull);
    EXPECT_EQ(moves.dropped, 0);
    EXPECT_EQ(moves.outside, 0);
    std::int64_t moved = 0;
    for (const std::int64_t n : sources.used) {
        const Vec3& p = sources.surface.points[n];
        if (before.points[n].x <= 0) {
            ASSERT_EQ(p, before.points[n]);
            continue;
        }
        ++moved;
        EXPECT_LE(norm(p), 80 - kShortestMm);
        EXPECT_GE(norm(p), 80 - kLongestMm - kChordMm);
    }
    EXPECT_EQ(moves.moved, moved);
    EXPECT_LE(moves.farthestMm, kLongestMm - 2 + kChordMm + 1);
    EXPECT_GE(moves.meanMm, kShortestMm - 2 - kChordMm);
}

TEST(SourceSpace, SourcesFartherOutThanAnEdgeAreDropped) {
    TriangleMesh cortex = icosphere(3, {}, 60);
    cortex.points[0] = 95 / norm(cortex.points[0]) * cortex.points[0];
    cortex.points[1] = 85 / norm(cortex.points[1]) * cortex.points[1];
    SourceSpace sources = surfaceSources(cortex, 1'000'000);
    const SourceMoves moves = keepWithin(sources, kSkull);
    EXPECT_EQ(moves.outside, 2);
    EXPECT_EQ(moves.dropped, 1);
    EXPECT_EQ(moves.moved, 1);
    EXPECT_EQ(sources.used.size(), cortex.points.size() - 1);
    EXPECT_EQ(pointsOutside(cortex.points, kSkull), 2);
}

TEST(SourceSpace, AGridHasAllItsPointsThatLieDeepEnough) {
    const SourceSpace sources = gridSources(kSkull, 10);
    ASSERT_TRUE(sources.grid);
    EXPECT_EQ(sources.surface.points.size(), static_cast<std::size_t>(sources.grid->voxelCount()));
    std::int64_t most = 0, least = 0;
    for (const Vec3& p : sources.surface.points) {
        most += norm(p) <= 80 - kShortestMm ? 1 : 0;
        least += norm(p) <= 80 - kLongestMm - kChordMm ? 1 : 0;
    }
    EXPECT_LE(std::ssize(sources.used), most);
    EXPECT_GE(std::ssize(sources.used), least);
    EXPECT_EQ(sources.orientations(sources.used[0]).size(), 3u);
}

}  // namespace
}  // namespace adaptiso
