#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "PulledBall.h"

namespace adaptiso::testing {
namespace {

using detail::ErrorBound;
using detail::SimplifiedSurface;

/// How much larger than the distance the bound may be: it grows by a hundredth at a time, is no
/// tighter than a hundredth of a voxel, and pieces are cut a few times only.
constexpr double kLoose = 1.05, kEnough = 0.02;
/// Crossings lie that near to the ball: its distance bends by 1 / 7 mm along an edge of 1 mm.
constexpr double kInterpolation = 1.0 / (8 * 7);

}  // namespace

TEST(ErrorProof, SaysThatTheFullSurfaceIsNear) {
    const ProvedBall ball;
    const ErrorBound bound = ball.proof(0.1).prove(ball.full);
    EXPECT_LE(bound.largestMm, kEnough);
    EXPECT_TRUE(bound.beyondLimit.empty());
}

// Every vertex moves by d, so every triangle lies within d of the one that it was; and the vertices
// lie d outside of a ball that holds the whole surface, but for what marching cubes rounds.
TEST(ErrorProof, BoundsASphereMovedOutward) {
    const ProvedBall ball;
    for (const double mm : {0.1, 0.5, 1.2}) {
        const ErrorBound bound = ball.proof().prove(ball.outward(mm));
        EXPECT_GE(bound.largestMm, mm - 2 * kInterpolation) << mm;
        EXPECT_LE(bound.largestMm, kLoose * mm + kEnough) << mm;
        EXPECT_TRUE(bound.beyondLimit.empty());
        EXPECT_TRUE(ball.proof(1.1 * mm).prove(ball.outward(mm)).beyondLimit.empty()) << mm;
        EXPECT_GT(ball.proof(0.8 * mm).prove(ball.outward(mm)).beyondLimit.size(), 100U) << mm;
    }
}

TEST(ErrorProof, FindsAVertexThatWasPulledOut) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    const Vec3 place = kBallMiddle + kBallRadius * normalized({1, 2, 3});
    const std::uint32_t vertex = ball.vertexAt(place);
    const auto changes = pull(surface, vertex, 2);
    const ErrorBound bound = ball.proof(0.5).prove(surface);
    EXPECT_GE(bound.largestMm, 2 - 2 * kInterpolation);
    EXPECT_LE(bound.largestMm, kLoose * 2);
    ASSERT_FALSE(bound.beyondLimit.empty());
    for (const auto& beyond : bound.beyondLimit) {
        EXPECT_LE(norm(beyond.point() - surface.points[vertex]), 3);  // a triangle is 2.5 mm long
        if (beyond.isOfFine) continue;
        EXPECT_EQ(std::count(changes.triangles.begin(), changes.triangles.end(), beyond.triangle),
                  1);
    }
}

// All that is left lies on the full surface; what is missing shows from the other side alone.
TEST(ErrorProof, FindsWhatTheSimplifiedSurfaceLacks) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    std::erase_if(surface.triangles, [&](const auto& t) {
        const Vec3 p = surface.points[t[0]] - kBallMiddle;
        return p.z > 0 && std::hypot(p.x, p.y) < 3;
    });
    ASSERT_LT(surface.triangles.size(), ball.full.triangles.size() - 20);
    for (std::uint32_t& t : surface.sampleTriangle) {
        if (t >= surface.triangles.size()) t = 0;
    }
    const ErrorBound bound = ball.proof(0.5).prove(surface);
    const TriangleMesh left = meshOf(surface);
    double farthest = 0;
    for (const Vec3& p : ball.full.points) farthest = std::max(farthest, distanceTo(left, p));
    EXPECT_GT(farthest, 2);
    EXPECT_GE(bound.largestMm, farthest);
    // points between the vertices may lie half a triangle's side farther
    EXPECT_LE(bound.largestMm, kLoose * farthest + 0.5);
    ASSERT_FALSE(bound.beyondLimit.empty());
    for (const auto& beyond : bound.beyondLimit) {
        EXPECT_TRUE(beyond.isOfFine);
        EXPECT_LE(norm(beyond.point() - (kBallMiddle + Vec3{0, 0, kBallRadius})), 5);
    }
}

}  // namespace adaptiso::testing
