#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/full/VolumeSurface.h"
#include "adaptive/rounds/Simplification.h"

namespace adaptiso::testing {
namespace {

using detail::Simplification;
using detail::SimplifiedSurface;
using detail::WantedCount;

struct SimplifiedBall {
    static constexpr double kDistanceMm = 0.2;

    Scene scene = ballScene();
    detail::VolumeSurface full{scene.volume.view().geometry(), *scene.sampler, scene.bricks};
    detail::PatchLimits limits;

    SimplifiedBall() { limits.maxDistanceMm = kDistanceMm; }
    Simplification simplification() const { return {full, limits}; }
};

double largestDistance(const SimplifiedSurface& surface) {
    double largest = 0;
    for (std::size_t s = 0; s < surface.samples.size(); ++s) {
        const auto& [a, b, c] = surface.triangles[surface.sampleTriangle[s]];
        largest = std::max(largest, detail::squaredDistanceToTriangle(
                                        surface.samples[s].point(),
                                        {surface.points[a], surface.points[b], surface.points[c]}));
    }
    return std::sqrt(largest);
}

}  // namespace

TEST(WantedCount, IsTheLeastOfWhatIsAskedFor) {
    EXPECT_FALSE(WantedCount{}.isGiven());
    EXPECT_EQ(WantedCount{}.of(1000), 1000);
    EXPECT_EQ((WantedCount{300, {}}.of(1000)), 300);
    EXPECT_EQ((WantedCount{5000, {}}.of(1000)), 1000);
    EXPECT_EQ((WantedCount{{}, 0.75}.of(1000)), 250);
    EXPECT_EQ((WantedCount{300, 0.75}.of(1000)), 250);
    EXPECT_EQ((WantedCount{200, 0.75}.of(1000)), 200);
}

TEST(Simplification, StaysWithinItsLimits) {
    const SimplifiedBall ball;
    const SimplifiedSurface surface = ball.simplification().toLimits();
    EXPECT_LE(largestDistance(surface), SimplifiedBall::kDistanceMm + kSampleRounding);
    EXPECT_LT(surface.triangleCount(), surface.fineTriangles / 8);
    expectSound(meshOf(surface));
    EXPECT_TRUE(surface.heirs.empty());  // nobody asked
}

// Merging the full surface's vertices into their heirs gives the surface.
TEST(Simplification, KeepsHeirsThatMakeTheSurface) {
    SimplifiedBall ball;
    ball.limits.keepsHeirs = true;
    for (const bool toCount : {false, true}) {
        const SimplifiedSurface surface = toCount ? ball.simplification().toCount({{}, 0.9}, 50)
                                                  : ball.simplification().toLimits();
        ASSERT_EQ(surface.heirs.size(), surface.fine.points.size());
        std::set<detail::SurfaceState::Triangle> merged, made;
        const auto turned = [](detail::SurfaceState::Triangle t) {
            std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
            return t;
        };
        for (const auto& t : surface.fine.triangles) {
            const auto& heirs = surface.heirs;
            const detail::SurfaceState::Triangle now{heirs[t[0]], heirs[t[1]], heirs[t[2]]};
            if (now[0] != now[1] && now[1] != now[2] && now[2] != now[0]) {
                merged.insert(turned(now));
            }
        }
        for (const auto& t : surface.triangles) made.insert(turned(t));
        EXPECT_EQ(merged, made);
    }
}

TEST(Simplification, MakesTheWantedCount) {
    const SimplifiedBall ball;
    for (const double reduction : {0.3, 0.75, 0.9}) {
        const WantedCount wanted{{}, reduction};
        const SimplifiedSurface surface = ball.simplification().toCount(wanted, 0);
        EXPECT_LE(surface.triangleCount(), wanted.of(surface.fineTriangles)) << reduction;
        EXPECT_GE(surface.triangleCount(), wanted.of(surface.fineTriangles) - 1) << reduction;
        EXPECT_LE(largestDistance(surface), SimplifiedBall::kDistanceMm + kSampleRounding)
            << reduction;
        expectSound(meshOf(surface));
    }
}

/// Whatever the round before made of it: no round leads below the count for good.
TEST(Simplification, NoCountIsPassed) {
    const SimplifiedBall ball;
    const std::int64_t fine = ball.simplification().toCount({{}, 0.0}, 0).fineTriangles;
    for (double part = 0.9; part > 0.15; part *= 0.8) {
        const auto wanted = static_cast<std::int64_t>(part * static_cast<double>(fine));
        const SimplifiedSurface surface = ball.simplification().toCount({wanted, {}}, 0);
        EXPECT_LE(surface.triangleCount(), wanted);
        EXPECT_GE(surface.triangleCount(), wanted - 1);
    }
}

TEST(Simplification, ASettledSurfaceStaysAsItIs) {
    SimplifiedBall ball;
    constexpr double kFar = 1e6;
    ball.full.stayIn({{kFar, kFar, kFar}, {kFar, kFar, kFar}}, BoundingBox::empty());
    const SimplifiedSurface surface = ball.simplification().toLimits();
    EXPECT_EQ(surface.triangleCount(), surface.fineTriangles);
    EXPECT_EQ(surface.points, ball.scene.fullSurface().points);
}

TEST(Simplification, GoesFartherForACountWhereItMay) {
    const SimplifiedBall ball;
    const WantedCount wanted{40, {}};
    EXPECT_GT(ball.simplification().toCount(wanted, 0).triangleCount(), 60);
    const SimplifiedSurface surface = ball.simplification().toCount(wanted, 50);
    EXPECT_LE(surface.triangleCount(), 40);
    EXPECT_GE(surface.triangleCount(), 39);
    EXPECT_GT(largestDistance(surface), SimplifiedBall::kDistanceMm);
    expectSound(meshOf(surface));
}

TEST(Simplification, FitsEveryVertexInTheEnd) {
    const SimplifiedBall ball;
    const SimplifiedSurface surface = ball.simplification().toLimits();
    EXPECT_EQ(
        std::count(surface.states.begin(), surface.states.end(), detail::Patch::State::Fitted),
        std::ssize(surface.states));
    EXPECT_TRUE(surface.quadrics.empty());
}

}  // namespace adaptiso::testing
