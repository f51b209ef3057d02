#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

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

TEST(DistanceProof, SaysThatTheFullSurfaceIsNear) {
    const ProvedBall ball;
    const ErrorBound bound = ball.proof(0.1).prove(ball.full);
    EXPECT_LE(bound.largestMm, kEnough);
    EXPECT_TRUE(bound.beyondLimit.empty());
}

// Every vertex moves by d, so every triangle lies within d of the one that it was; and the vertices
// lie d outside of a ball that holds the whole surface, but for what marching cubes rounds.
TEST(DistanceProof, BoundsASphereMovedOutward) {
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

TEST(DistanceProof, FindsAVertexThatWasPulledOut) {
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
TEST(DistanceProof, FindsWhatTheSimplifiedSurfaceLacks) {
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

    detail::DistanceProof proof(double limitMm) const { return proofOf(surface, scene, limitMm); }
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

TEST(DistanceProof, SaysThatNoiseAtFullResolutionIsThere) {
    for (const Border border : {Border::Open, Border::Closed}) {
        const Scene scene(whiteNoise({70, 20, 20}, 3), 0, border);
        const SimplifiedSurface surface = firstRoundOf(scene);
        detail::DistanceProof proof = proofOf(surface, scene, 0.3);
        EXPECT_EQ(proof.prove(surface).largestMm, 0);
        EXPECT_EQ(proof.isFine(), std::vector<std::uint8_t>(surface.triangles.size(), 1));
        // and under other numbers, by a look at all of it
        SimplifiedSurface turned = surface;
        std::reverse(turned.triangles.begin(), turned.triangles.end());
        const auto last = static_cast<std::uint32_t>(turned.triangles.size() - 1);
        for (std::uint32_t& t : turned.sampleTriangle) t = last - t;
        detail::DistanceProof anew = proofOf(surface, scene, 0.3);
        EXPECT_LE(anew.prove(turned).largestMm, kEnough);
        EXPECT_EQ(anew.isFine(), proof.isFine());
    }
}

// A triangle counts as one of the full surface as long as nothing of it has changed.
TEST(DistanceProof, KnowsTheTrianglesOfTheFullSurface) {
    const PartlyNoise partly;
    ASSERT_LT(partly.surface.triangleCount(), partly.surface.fineTriangles);
    const detail::FineMesh& fine = partly.surface.fine;
    std::set<Corners, bool (*)(const Corners&, const Corners&)> all(
        [](const Corners& a, const Corners& b) {
            return std::lexicographical_compare(
                a.begin(), a.end(), b.begin(), b.end(), [](const Vec3& p, const Vec3& q) {
                    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
                });
        });
    const auto fromLowest = [](Corners c) {
        std::rotate(c.begin(),
                    std::min_element(c.begin(), c.end(),
                                     [](const Vec3& p, const Vec3& q) {
                                         return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
                                     }),
                    c.end());
        return c;
    };
    for (const auto& [a, b, c] : fine.triangles) {
        all.insert(fromLowest({fine.points[a], fine.points[b], fine.points[c]}));
    }
    SimplifiedSurface surface = partly.surface;
    const auto expectSame = [&](const detail::DistanceProof& proof, const char* what) {
        SCOPED_TRACE(what);
        std::size_t same = 0;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            const auto& [a, b, c] = surface.triangles[t];
            const bool isSame =
                all.contains(fromLowest({surface.points[a], surface.points[b], surface.points[c]}));
            ASSERT_LE(proof.isFine()[t] != 0, isSame) << t;
            same += proof.isFine()[t];
        }
        EXPECT_GT(same, 1000U);
        EXPECT_LT(same, surface.triangles.size());
    };
    detail::DistanceProof proof = partly.proof(0.4);
    proof.prove(surface);
    expectSame(proof, "as it is");
    const std::uint32_t vertex = partly.vertexOfNoise();
    const Vec3 before = surface.points[vertex];
    const auto next = std::nextafter(before.x, 1e9);
    proof.proveAgain(surface, moveVertex(surface, vertex, {next, before.y, before.z}));
    expectSame(proof, "a vertex moved by a unit in the last place");
    const auto kept = proof.isFine();
    proof.proveAgain(surface, moveVertex(surface, vertex, before));
    expectSame(proof, "it is back");
    EXPECT_GT(std::count(proof.isFine().begin(), proof.isFine().end(), 1),
              std::count(kept.begin(), kept.end(), 1));
    std::swap(surface.triangles[5][0], surface.triangles[5][1]);
    detail::DistanceProof anew = partly.proof(0.4);
    anew.prove(surface);
    expectSame(anew, "a triangle is turned round");
}

TEST(DistanceProof, FindsAVertexOfNoiseThatWasPulledOut) {
    PartlyNoise partly;
    const Vec3 far{0, 0, 30};  // out of the volume
    const std::uint32_t vertex = partly.vertexOfNoise();
    detail::DistanceProof proof = partly.proof(0.5);
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
TEST(DistanceProof, ProvesNoiseThatChangedAfterAll) {
    const Scene scene(whiteNoise({40, 20, 20}, 3), 0, Border::Closed);
    SimplifiedSurface surface = firstRoundOf(scene);
    detail::DistanceProof proof = proofOf(surface, scene, 0.3);
    ASSERT_EQ(proof.prove(surface).largestMm, 0);
    const ErrorBound bound =
        proof.proveAgain(surface, moveVertex(surface, 0, surface.points[0] + Vec3{-20, 0, 0}));
    EXPECT_GE(bound.largestMm, 15);
    EXPECT_FALSE(bound.beyondLimit.empty());
}

}  // namespace adaptiso::testing
