#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <tuple>

#include "PulledBall.h"

namespace adaptiso::testing {
namespace {

using detail::DistanceProof;
using detail::ErrorBound;
using detail::SimplifiedSurface;

/// What was found, without its order.
std::set<std::tuple<double, double, double, bool>> placesOf(const ErrorBound& bound) {
    std::set<std::tuple<double, double, double, bool>> places;
    for (const auto& place : bound.beyondLimit) {
        const Vec3& p = place.point();
        places.insert({p.x, p.y, p.z, place.isOfFine});
    }
    return places;
}

/// Every place of one is one of the other, but for how pieces were cut.
bool isAmong(const ErrorBound& some, const ErrorBound& all) {
    return std::all_of(some.beyondLimit.begin(), some.beyondLimit.end(), [&](const auto& place) {
        return std::any_of(all.beyondLimit.begin(), all.beyondLimit.end(), [&](const auto& other) {
            return place.isOfFine == other.isOfFine && norm(place.point() - other.point()) < 0.7;
        });
    });
}

}  // namespace

TEST(DistanceProof, SaysAgainWhatProvingAnewSays) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    DistanceProof kept = ball.proof(0.5);
    ASSERT_TRUE(kept.prove(surface).beyondLimit.empty());
    std::mt19937 random(4);
    for (int n = 0; n < 4; ++n) {
        const auto vertex = static_cast<std::uint32_t>(random() % surface.points.size());
        const ErrorBound again = kept.proveAgain(surface, pull(surface, vertex, 1.5));
        const ErrorBound anew = ball.proof(0.5).prove(surface);
        EXPECT_FALSE(anew.beyondLimit.empty()) << n;
        EXPECT_TRUE(isAmong(again, anew) && isAmong(anew, again)) << n;
        EXPECT_NEAR(again.largestMm, anew.largestMm, 0.1) << n;
        const ErrorBound back = kept.proveAgain(surface, pull(surface, vertex, -1.5));
        EXPECT_TRUE(back.beyondLimit.empty()) << n;
    }
}

// Nothing is beyond no limit; the bound is what was proved of all that is still there.
TEST(DistanceProof, BoundsAgainWithoutALimit) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    constexpr double kNoLimit = std::numeric_limits<double>::max();
    DistanceProof kept = ball.proof(kNoLimit);
    double largestMm = kept.prove(surface).largestMm;
    EXPECT_LT(largestMm, 0.05);
    std::mt19937 random(5);
    for (const double mm : {0.2, 0.6, 1.5}) {
        const auto vertex = static_cast<std::uint32_t>(random() % surface.points.size());
        const ErrorBound again = kept.proveAgain(surface, pull(surface, vertex, mm));
        const ErrorBound anew = ball.proof(kNoLimit).prove(surface);
        EXPECT_GT(anew.largestMm, 0.5 * mm);
        EXPECT_NEAR(again.largestMm, std::max(anew.largestMm, largestMm), 0.05);
        EXPECT_TRUE(again.beyondLimit.empty());
        largestMm = again.largestMm;
    }
}

TEST(DistanceProof, FindsAgainWhatWasNotMended) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    pull(surface, ball.vertexAt({28, 28, 40}), 1.5);
    DistanceProof kept = ball.proof(0.5);
    const ErrorBound first = kept.prove(surface), again = kept.proveAgain(surface, {});
    EXPECT_FALSE(first.beyondLimit.empty());
    EXPECT_TRUE(isAmong(first, again) && isAmong(again, first));
}

// Triangles that go and leave nothing in their place: the full surface there has lost what was
// near.
TEST(DistanceProof, LooksAgainWhereTrianglesWent) {
    const ProvedBall ball;
    SimplifiedSurface surface = ball.full;
    DistanceProof kept = ball.proof(0.5);
    ASSERT_TRUE(kept.prove(surface).beyondLimit.empty());
    detail::SurfaceChanges changes;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        const auto& p = surface.points;
        if (p[a].z < kBallMiddle.z + kBallRadius - 0.6) continue;
        changes.triangles.push_back(t);
        changes.before.push_back({p[a], p[b], p[c]});
    }
    const auto isLow = [&](const auto& t) { return surface.points[t[0]].z < kBallMiddle.z; };
    const auto low = *std::find_if(surface.triangles.begin(), surface.triangles.end(), isLow);
    for (const std::uint32_t t : changes.triangles) surface.triangles[t] = low;
    const ErrorBound again = kept.proveAgain(surface, changes);
    const ErrorBound anew = ball.proof(0.5).prove(surface);
    EXPECT_FALSE(again.beyondLimit.empty());
    EXPECT_TRUE(isAmong(again, anew));  // which is cut finer
    EXPECT_NEAR(again.largestMm, anew.largestMm, 0.1);
}

// Another surface altogether, of which the proof remembers what it has in common with the last.
TEST(DistanceProof, RemembersNothingWrongOfTheLastSurface) {
    const ProvedBall ball;
    DistanceProof kept = ball.proof(0.5);
    for (const double mm : {0.0, 0.2, 1.5, 0.2}) {
        SimplifiedSurface surface = ball.full;
        pull(surface, ball.vertexAt(kBallMiddle + Vec3{0, 0, 9}), mm);
        pull(surface, ball.vertexAt(kBallMiddle + Vec3{9, 0, 0}), 1.5 - mm);
        EXPECT_EQ(placesOf(kept.prove(surface)), placesOf(ball.proof(0.5).prove(surface))) << mm;
    }
}

}  // namespace adaptiso::testing
