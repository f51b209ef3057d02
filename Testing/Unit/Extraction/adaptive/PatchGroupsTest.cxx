#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "PatchedBall.h"
#include "adaptiso/SurfaceProof/PieceBound.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;

}  // namespace

TEST(PatchGroups, HaveEveryTriangleOnce) {
    PatchedBall ball;
    std::map<Key, int> owners;
    for (std::size_t n = 0; n < ball.groups.count(); ++n) {
        const Patch patch = ball.groups.take(n, ball.scratch);
        EXPECT_EQ(patch.ownTriangles, ball.groups.triangleCount(n));
        for (std::uint32_t t = 0; t < patch.ownTriangles; ++t) ++owners[keyOf(patch, t)];
    }
    std::size_t straddling = 0;
    for (std::uint32_t t = 0; t < ball.surface.triangles.size(); ++t) {
        straddling += ball.straddles(t) ? 1 : 0;
        EXPECT_EQ(owners[ball.key(t)], ball.straddles(t) ? 0 : 1);
    }
    EXPECT_GT(straddling, 100U);
    EXPECT_LT(straddling, ball.surface.triangles.size() / 2);
}

TEST(PatchGroups, KeepEachPatchInItsCube) {
    PatchedBall ball;
    for (std::size_t n = 0; n < ball.groups.count(); ++n) {
        const Patch patch = ball.groups.take(n, ball.scratch);
        if (patch.ownTriangles == 0) continue;
        const Index3 cube = cubeOf(patch.points[patch.triangles[0][0]]);
        for (int a = 0; a < 3; ++a) {
            const double low = 12.0 * static_cast<double>(cube[a]) + 5;
            EXPECT_NEAR(patch.lowIndex[a], low, 1e-3);
            EXPECT_GT(patch.lowIndex[a], low);  // two patches never meet in a wall
            EXPECT_NEAR(patch.highIndex[a], low + 12, 1e-3);
            EXPECT_LT(patch.highIndex[a], low + 12);
        }
        for (std::uint32_t t = 0; t < patch.ownTriangles; ++t) {
            for (const std::uint32_t v : patch.triangles[t]) {
                EXPECT_EQ(cubeOf(patch.points[v]), cube);
            }
        }
    }
}

// Whoever has a vertex in the cube is there, so that nothing crosses it and no vertex moves that it
// shares.
TEST(PatchGroups, HaveTheTrianglesAroundAsObstacles) {
    PatchedBall ball;
    for (std::size_t n = 0; n < ball.groups.count(); ++n) {
        const Patch patch = ball.groups.take(n, ball.scratch);
        if (patch.ownTriangles == 0) continue;
        const Index3 cube = cubeOf(patch.points[patch.triangles[0][0]]);
        std::set<Key> obstacles;
        for (std::uint32_t t = patch.ownTriangles; t < patch.triangles.size(); ++t) {
            obstacles.insert(keyOf(patch, t));
        }
        for (std::uint32_t t = 0; t < ball.surface.triangles.size(); ++t) {
            bool touches = false;
            for (const std::uint32_t v : ball.surface.triangles[t]) {
                touches = touches || cubeOf(ball.surface.points[v]) == cube;
            }
            if (touches && ball.straddles(t)) {
                EXPECT_TRUE(obstacles.contains(ball.key(t)));
            }
        }
    }
}

TEST(PatchGroups, GiveSamplesToTheirTriangles) {
    PatchedBall ball;
    std::size_t own = 0;
    for (std::size_t n = 0; n < ball.groups.count(); ++n) {
        const Patch patch = ball.groups.take(n, ball.scratch);
        ASSERT_EQ(patch.samples.size(), patch.sampleTriangle.size());
        for (std::size_t s = 0; s < patch.samples.size(); ++s) {
            const auto& [a, b, c] = patch.triangles[patch.sampleTriangle[s]];
            EXPECT_NEAR(
                detail::squaredDistanceToTriangle(
                    patch.samples[s].point(), {patch.points[a], patch.points[b], patch.points[c]}),
                0, 1e-9);
            own += patch.sampleTriangle[s] < patch.ownTriangles ? 1 : 0;
        }
    }
    std::size_t expected = 0;
    for (const std::uint32_t t : ball.surface.sampleTriangle) expected += ball.straddles(t) ? 0 : 1;
    EXPECT_EQ(own, expected);
}

// Most of the ball is final. Its triangles are no patch's own; in a patch that has own triangles,
// they are obstacles wherever a new vertex may come to lie.
TEST(PatchGroups, KeepSettledTrianglesAsObstaclesNearOwnOnes) {
    PatchedBall ball;
    for (std::size_t v = 0; v < ball.surface.points.size(); ++v) {
        if (ball.surface.points[v].z > kBallMiddle.z - 4) {
            ball.surface.states[v] = Patch::State::Final;
        }
    }
    const auto isSettled = [&](std::uint32_t t) {
        const auto& c = ball.surface.triangles[t];
        return std::all_of(c.begin(), c.end(), [&](std::uint32_t v) {
            return ball.surface.states[v] == Patch::State::Final;
        });
    };
    const detail::PatchGroups groups(ball.surface, kCut, ball.scene.frame);
    std::map<Key, int> owners;
    std::size_t settledObstacles = 0;
    for (std::size_t n = 0; n < groups.count(); ++n) {
        const Patch patch = groups.take(n, ball.scratch);
        std::map<Key, int> here;
        for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) ++here[keyOf(patch, t)];
        for (std::uint32_t t = 0; t < patch.ownTriangles; ++t) ++owners[keyOf(patch, t)];
        if (patch.ownTriangles == 0) {
            EXPECT_TRUE(patch.triangles.empty());
            EXPECT_TRUE(groups.isIdle(n));
            continue;
        }
        const BoundingBox room{patch.lowIndex, patch.highIndex};  // voxels are 1 mm
        for (std::uint32_t t = 0; t < ball.surface.triangles.size(); ++t) {
            const auto& [a, b, c] = ball.surface.triangles[t];
            const BoundingBox box =
                boxOf({ball.surface.points[a], ball.surface.points[b], ball.surface.points[c]});
            if (!isSettled(t) || !box.overlaps(room)) continue;
            EXPECT_EQ(here[ball.key(t)], 1);
            ++settledObstacles;
        }
    }
    std::size_t settled = 0;
    for (std::uint32_t t = 0; t < ball.surface.triangles.size(); ++t) {
        settled += isSettled(t) ? 1 : 0;
        EXPECT_EQ(owners[ball.key(t)], isSettled(t) || ball.straddles(t) ? 0 : 1);
    }
    EXPECT_GT(settledObstacles, 50U);
    EXPECT_LT(settledObstacles, settled / 2);
}

TEST(PatchGroups, ShareOutBySize) {
    const PatchedBall ball;
    for (const std::int64_t total : {0, 1, 100, 777}) {
        const auto shares = ball.groups.shares(total);
        EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), std::int64_t{0}), total);
        double all = 0;
        for (std::size_t n = 0; n < ball.groups.count(); ++n) {
            all += static_cast<double>(ball.groups.triangleCount(n));
        }
        for (std::size_t n = 0; n < ball.groups.count(); ++n) {
            const double due = static_cast<double>(total * ball.groups.triangleCount(n)) / all;
            EXPECT_NEAR(static_cast<double>(shares[n]), due, 1);
        }
    }
}

}  // namespace adaptiso::testing
