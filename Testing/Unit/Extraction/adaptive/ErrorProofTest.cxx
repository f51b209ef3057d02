#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "NoisyScenes.h"
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

namespace {

/// Noise in the first brick, a smooth surface in two others.
struct PartlyNoise {
    Scene scene{noiseBesideSmooth({70, 20, 20}, {}, 5), 0, Border::Open};
    SimplifiedSurface surface = firstRoundOf(scene);

    detail::ErrorProof proof(double limitMm) const {
        return {*scene.sampler, scene.bricks, scene.frame, limitMm};
    }
    /// The same, proved as if nothing were known of whole bricks.
    ErrorBound proveAll(double limitMm) const {
        SimplifiedSurface unknown = surface;
        for (auto& print : unknown.prints) ++print.sum;
        return proof(limitMm).prove(unknown);
    }
    /// A vertex of the noise, away from the brick's walls.
    std::uint32_t vertexOfNoise() const {
        const Vec3 place{15, 10, 10};
        const auto at = std::min_element(
            surface.points.begin(), surface.points.end(),
            [&](const Vec3& p, const Vec3& q) { return norm(p - place) < norm(q - place); });
        return static_cast<std::uint32_t>(at - surface.points.begin());
    }
};

}  // namespace

TEST(ErrorProof, SaysThatNoiseAtFullResolutionIsThere) {
    const Scene scene(whiteNoise({40, 20, 20}, 3), 0, Border::Closed);
    SimplifiedSurface surface = firstRoundOf(scene);
    detail::ErrorProof proof(*scene.sampler, scene.bricks, scene.frame, 0.3);
    EXPECT_EQ(proof.prove(surface).largestMm, 0);
    // and by a look at all of it
    for (auto& print : surface.prints) ++print.sum;
    EXPECT_LE(
        detail::ErrorProof(*scene.sampler, scene.bricks, scene.frame, 0.3).prove(surface).largestMm,
        kEnough);
}

TEST(ErrorProof, SaysOfPartlyNoiseWhatALookAtAllOfItSays) {
    const PartlyNoise partly;
    ASSERT_TRUE(partly.surface.wasLeftWhole(0));
    ASSERT_LT(partly.surface.triangleCount(), partly.surface.fineTriangles);
    for (const double limitMm : {0.1, 0.4}) {
        const ErrorBound bound = partly.proof(limitMm).prove(partly.surface);
        const ErrorBound all = partly.proveAll(limitMm);
        EXPECT_GT(bound.largestMm, 0.05);
        EXPECT_NEAR(bound.largestMm, all.largestMm, 0.01 * all.largestMm) << limitMm;
        EXPECT_EQ(bound.beyondLimit.size(), all.beyondLimit.size()) << limitMm;
    }
}

// What was left whole has no samples: the triangles of its vertices are found by their places.
TEST(ErrorProof, FindsAVertexOfNoiseThatWasPulledOut) {
    PartlyNoise partly;
    const Vec3 far{0, 0, 30};  // out of the volume
    const std::uint32_t vertex = partly.vertexOfNoise();
    detail::ErrorProof proof = partly.proof(0.5);
    ASSERT_LE(proof.prove(partly.surface).largestMm, 0.5);
    const SimplifiedSurface before = partly.surface;
    detail::SurfaceChanges changes;
    for (std::uint32_t t = 0; t < before.triangles.size(); ++t) {
        const auto& c = before.triangles[t];
        if (std::find(c.begin(), c.end(), vertex) == c.end()) continue;
        changes.triangles.push_back(t);
        changes.before.push_back({before.points[c[0]], before.points[c[1]], before.points[c[2]]});
    }
    partly.surface.points[vertex] += far;
    const ErrorBound again = proof.proveAgain(partly.surface, changes),
                     anew = partly.proof(0.5).prove(partly.surface);
    for (const ErrorBound& bound : {again, anew}) {
        EXPECT_GE(bound.largestMm, 20);  // 30 less the height of the volume above it, and a cell
        EXPECT_LE(bound.largestMm, kLoose * 30);
        EXPECT_FALSE(bound.beyondLimit.empty());
    }
    // and back
    for (std::size_t n = 0; n < changes.triangles.size(); ++n) {
        const auto& c = partly.surface.triangles[changes.triangles[n]];
        changes.before[n] = {partly.surface.points[c[0]], partly.surface.points[c[1]],
                             partly.surface.points[c[2]]};
    }
    partly.surface = before;
    EXPECT_TRUE(proof.proveAgain(partly.surface, changes).beyondLimit.empty());
}

// All is noise, and then it is not: there is nothing that an earlier proof could have left.
TEST(ErrorProof, ProvesNoiseThatChangedAfterAll) {
    const Scene scene(whiteNoise({40, 20, 20}, 3), 0, Border::Closed);
    SimplifiedSurface surface = firstRoundOf(scene);
    detail::ErrorProof proof(*scene.sampler, scene.bricks, scene.frame, 0.3);
    ASSERT_EQ(proof.prove(surface).largestMm, 0);
    surface.points[0] += {-20, 0, 0};
    const ErrorBound bound = proof.proveAgain(surface, {});
    EXPECT_GE(bound.largestMm, 15);
    EXPECT_FALSE(bound.beyondLimit.empty());
}

}  // namespace adaptiso::testing
