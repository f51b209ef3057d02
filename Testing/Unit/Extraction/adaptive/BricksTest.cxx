#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "Surfaces.h"
#include "adaptive/bricks/Bricks.h"

namespace adaptiso::testing {
namespace {

using detail::Brick;
using detail::BrickMesher;
using detail::FineSurface;

}  // namespace

TEST(Bricks, HaveEachActiveBlockOnce) {
    const Scene scene = ballScene();
    const BlockGrid& grid = scene.bricks.grid();
    std::vector<std::uint32_t> blocks;
    for (std::int64_t b = 0; b < scene.bricks.count(); ++b) {
        const Brick& brick = scene.bricks[b];
        EXPECT_TRUE(std::is_sorted(brick.blocks.begin(), brick.blocks.end()));
        for (const std::uint32_t block : brick.blocks) {
            const Index3 first = grid.firstSample(block);
            for (int a = 0; a < 3; ++a) {
                EXPECT_GE(first[a] + grid.offset, brick.low[a]);
                EXPECT_LE(first[a] + grid.offset + grid.blockSize, brick.low[a] + Brick::kSide);
            }
        }
        blocks.insert(blocks.end(), brick.blocks.begin(), brick.blocks.end());
    }
    std::sort(blocks.begin(), blocks.end());
    EXPECT_EQ(blocks, scene.index.blocksAt(0).blocks);
}

TEST(Bricks, KnowWhichVerticesTheyMayShare) {
    const Scene scene = ballScene();
    BrickMesher mesher(*scene.sampler, scene.bricks.grid());
    FineSurface fine;
    std::map<std::uint64_t, int> bricksAt;
    std::vector<std::pair<std::uint64_t, bool>> isOnWall;  // as each brick says
    for (std::int64_t b = 0; b < scene.bricks.count(); ++b) {
        mesher.mesh(scene.bricks[b], fine);
        for (const auto& vertex : fine.vertices) {
            ++bricksAt[vertex.edge.word];
            isOnWall.emplace_back(vertex.edge.word, vertex.isOnWall);
        }
    }
    EXPECT_GT(isOnWall.size(), bricksAt.size() + 100);
    EXPECT_LT(isOnWall.size(), bricksAt.size() * 5 / 4);
    for (const auto& [edge, isShared] : isOnWall) EXPECT_EQ(isShared, bricksAt[edge] > 1);
}

TEST(Bricks, KnowWhereNoOtherSheetIsNear) {
    // a slab of one sample at z = 8, and a floor at z = 20
    const Scene scene(
        {30, 30, 30}, [](const Vec3& p) { return std::max(0.6 - std::abs(p.z - 8), p.z - 20.3); },
        Border::Open);
    BrickMesher mesher(*scene.sampler, scene.bricks.grid());
    FineSurface fine;
    ASSERT_EQ(scene.bricks.count(), 1);
    mesher.mesh(scene.bricks[0], fine);
    for (const auto& vertex : fine.vertices) {
        ASSERT_EQ(vertex.isSingleSheet, vertex.index.z > 15) << vertex.index.z;
    }
}

// Webs .1 voxel thick in planes of samples: also where the other side is another brick's.
TEST(Bricks, KnowHowThinTheSurfaceIs) {
    for (const double second : {30.0, 31.0, 32.0, 33.0}) {
        const Scene scene(
            {40, 12, 12},
            [&](const Vec3& p) {
                return 0.05 - std::min(std::abs(p.x - 8), std::abs(p.x - second));
            },
            Border::Open);
        BrickMesher mesher(*scene.sampler, scene.bricks.grid());
        FineSurface fine;
        std::size_t vertices = 0;
        for (std::int64_t b = 0; b < scene.bricks.count(); ++b) {
            mesher.mesh(scene.bricks[b], fine);
            mesher.findGaps(scene.bricks[b], fine);
            for (const auto& vertex : fine.vertices) EXPECT_NEAR(vertex.gap, 0.1, 1e-6);
            vertices += fine.vertices.size();
        }
        EXPECT_GT(vertices, 500U);
    }
}

// Around the ball's poles lines of the lattice leave it again soon.
TEST(Bricks, FindTheOtherEndOfAGap) {
    const Scene scene = ballScene();
    BrickMesher mesher(*scene.sampler, scene.bricks.grid());
    FineSurface fine;
    std::vector<detail::FineVertex> vertices;
    for (std::int64_t b = 0; b < scene.bricks.count(); ++b) {
        mesher.mesh(scene.bricks[b], fine);
        mesher.findGaps(scene.bricks[b], fine);
        vertices.insert(vertices.end(), fine.vertices.begin(), fine.vertices.end());
    }
    int gaps = 0;
    for (const detail::FineVertex& vertex : vertices) {
        if (vertex.gap == detail::FineVertex::kNoGap) continue;
        ++gaps;
        EXPECT_TRUE(std::any_of(vertices.begin(), vertices.end(), [&](const auto& other) {
            Vec3 step = other.index - vertex.index;
            const double along = std::abs(std::exchange(step[vertex.edge.axis()], 0.0));
            return norm(step) == 0 && std::abs(along - vertex.gap) < 1e-6;
        }));
    }
    EXPECT_GT(gaps, 0);
}

}  // namespace adaptiso::testing
