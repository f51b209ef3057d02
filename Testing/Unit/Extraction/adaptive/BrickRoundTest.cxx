#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "NoisyScenes.h"
#include "Surfaces.h"
#include "adaptive/rounds/BrickRound.h"

namespace adaptiso::testing {
namespace {

/// Sheets about two voxels apart, in whole numbers: many samples equal the isovalue 5.
Volume layeredVolume(std::int64_t side) {
    ImageGeometry geometry;
    geometry.size = {side, side, side};
    std::vector<std::uint8_t> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side % side),
                   z = static_cast<double>(i / (side * side));
        const double phase = 1.5 * z + std::sin(0.3 * x) + std::cos(0.2 * y);
        samples.push_back(static_cast<std::uint8_t>(std::lround(5 + 4 * std::sin(phase))));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace

// Bricks are simplified side by side, each without a look at the others: what reached into a
// neighbour could meet its triangles.
TEST(BrickRound, KeepsEachTriangleInOneBrick) {
    for (const Border border : {Border::Closed, Border::Open}) {
        const Scene scene(layeredVolume(44), 5, border);
        ASSERT_GE(scene.bricks.count(), 8);
        detail::PatchLimits limits;
        limits.maxCost = 10;
        limits.maxDistanceMm = 0.5;
        const detail::SimplifiedSurface surface =
            detail::simplifyBricks(*scene.sampler, scene.bricks, scene.frame, limits, nullptr);
        ASSERT_LT(surface.triangleCount(), surface.fineTriangles / 2);
        const auto offset = static_cast<double>(scene.bricks.grid().offset);
        constexpr double kRounding = 1e-9;  // of coordinates up to 100
        for (const auto& t : surface.triangles) {
            Vec3 low = surface.points[t[0]], high = low;
            for (const std::uint32_t v : t) {
                const Vec3& p = surface.points[v];
                low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
            }
            for (int a = 0; a < 3; ++a) {
                const double wall = detail::Brick::kSide *
                                    std::ceil((low[a] + offset + kRounding) / detail::Brick::kSide);
                ASSERT_LE(high[a] + offset, wall + kRounding);
            }
        }
    }
}

TEST(BrickRound, LeavesWhatMayNotMoveAtFullResolution) {
    const Scene scene = ballScene();
    detail::PatchLimits limits;
    limits.maxCost = 10;
    limits.maxDistanceMm = 0.5;
    const auto simplified = [&](double highest) {
        BoundingBox moving{{-1, -1, -1}, {1e3, 1e3, highest}};
        return detail::simplifyBricks(*scene.sampler, scene.bricks, scene.frame, limits, nullptr,
                                      &moving);
    };
    const detail::SimplifiedSurface surface = simplified(kBallMiddle.z + 0.5 * kBallRadius);
    EXPECT_GT(surface.triangleCount(), simplified(1e3).triangleCount() + 20);
    EXPECT_LT(surface.triangleCount(), surface.fineTriangles / 2);
    EXPECT_EQ(simplified(-0.5).triangleCount(), surface.fineTriangles);
}

// A web .1 voxel thick at x = 8, and a ball that is not.
TEST(BrickRound, KeepsWebsCloser) {
    const Scene scene({64, 30, 30}, [](const Vec3& p) {
        return std::max(0.05 - std::abs(p.x - 8), 10 - norm(p - Vec3{44, 15, 15}));
    });
    detail::PatchLimits limits;
    limits.maxCost = 1e-3;
    limits.maxDistanceMm = 0.1;
    for (const double webMm : {0.0, 0.09, 0.11}) {
        limits.webMm = webMm;
        const detail::SimplifiedSurface surface =
            detail::simplifyBricks(*scene.sampler, scene.bricks, scene.frame, limits, nullptr);
        std::size_t closer = 0;
        for (const detail::Sample& sample : surface.samples) {
            const bool isOfBall = sample.point().x > 20;
            if (isOfBall) {
                ASSERT_FALSE(sample.isInWeb);
            }
            closer += sample.isInWeb ? 1 : 0;
        }
        EXPECT_EQ(closer > 1000, webMm == 0.11) << webMm;
    }
}

// What the proof is given: all of marching cubes' surface, whatever was collapsed, and the samples
// of its vertices in their order.
TEST(BrickRound, KeepsTheFullSurfaceAndTheSamplesOfItsVertices) {
    const Scene ball = ballScene();
    const Scene noisy(noiseBesideSmooth({70, 20, 20}, {}, 5), 0, Border::Open);
    for (const Scene* scene : {&ball, &noisy}) {
        const detail::SimplifiedSurface surface = firstRoundOf(*scene);
        EXPECT_LT(surface.triangleCount(), surface.fineTriangles);
        EXPECT_EQ(std::ssize(surface.fine.triangles), surface.fineTriangles);
        std::size_t vertex = 0;
        for (const detail::Sample& sample : surface.samples) {
            if (sample.isMiddle) continue;
            ASSERT_LT(vertex, surface.fine.points.size());
            EXPECT_EQ(sample.position, detail::Sample::positionOf(surface.fine.points[vertex++]));
        }
        EXPECT_EQ(vertex, surface.fine.points.size());
        // without collapses the surface is the same triangle by triangle
        const detail::SimplifiedSurface full = scene->fullSurface();
        ASSERT_EQ(full.triangles.size(), surface.fine.triangles.size());
        for (std::size_t t = 0; t < full.triangles.size(); ++t) {
            for (int c = 0; c < 3; ++c) {
                ASSERT_EQ(surface.fine.points[surface.fine.triangles[t][c]],
                          full.points[full.triangles[t][c]]);
            }
        }
    }
}

// A brick of noise keeps its walls too, of which a brick before it may have the vertices.
TEST(BrickRound, LeavesNoiseWholeUpToItsWalls) {
    for (const bool isMirrored : {false, true}) {  // noise comes first, or last
        const Index3 size{64, 20, 20};
        const Volume made = noiseBesideSmooth(size, {}, 5);
        const auto samples = made.view().as<float>();
        std::vector<float> values;
        for (std::int64_t i = 0; i < made.view().geometry().voxelCount(); ++i) {
            const std::int64_t x = i % size[0];
            values.push_back(samples.at(isMirrored ? size[0] - 1 - x : x, i / size[0] % size[1],
                                        i / (size[0] * size[1])));
        }
        const Scene scene(Volume::fromSamples(std::move(values), unitGeometry(size)), 0,
                          Border::Open);
        ASSERT_EQ(scene.bricks.count(), 2);
        const detail::SimplifiedSurface surface = firstRoundOf(scene);
        EXPECT_EQ(surface.quadrics.size(), surface.points.size());
        const auto vertices = std::count_if(surface.samples.begin(), surface.samples.end(),
                                            [](const auto& s) { return !s.isMiddle; });
        EXPECT_EQ(vertices, std::ssize(surface.fine.points));
        const auto isWhole = [](const detail::SimplifiedSurface& s, bool inNoise) {
            for (std::size_t v = 0; v < s.points.size(); ++v) {
                if ((s.points[v].x < detail::Brick::kSide) != inNoise) continue;
                if (s.states[v] != detail::Patch::State::Final) return false;
            }
            return true;
        };
        EXPECT_TRUE(isWhole(surface, !isMirrored));
        EXPECT_FALSE(isWhole(surface, isMirrored));
        std::size_t onWall = 0;
        for (std::size_t v = 0; v < surface.points.size(); ++v) {
            if (surface.points[v].x != detail::Brick::kSide) continue;
            ++onWall;
            EXPECT_EQ(surface.states[v], detail::Patch::State::Final);
        }
        EXPECT_GT(onWall, 10U);
        // to a count nothing is left
        detail::PatchLimits limits = limitsThatLeaveNoise();
        limits.leavesNoise = false;
        const auto all =
            detail::simplifyBricks(*scene.sampler, scene.bricks, scene.frame, limits, nullptr);
        EXPECT_FALSE(isWhole(all, !isMirrored));
        EXPECT_EQ(all.fineTriangles, surface.fineTriangles);
        EXPECT_EQ(all.tableTriangles, surface.tableTriangles);
    }
}

}  // namespace adaptiso::testing
