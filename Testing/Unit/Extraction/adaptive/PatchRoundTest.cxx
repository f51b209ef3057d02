#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/rounds/PatchRound.h"

namespace adaptiso::testing {
namespace {

using detail::PatchWork;
using detail::SimplifiedSurface;

constexpr detail::PatchCut kCut{16, {12, 12, 12}};

/// A ball's full surface in a voxel of 1 mm.
struct RoundBall {
    static constexpr double kDistanceMm = 0.2;

    Scene scene = ballScene();
    SimplifiedSurface surface = scene.fullSurface();

    static detail::PatchLimits limits() {
        detail::PatchLimits limits;
        limits.maxCost = 1;
        limits.maxDistanceMm = kDistanceMm;
        return limits;
    }
    void run(const PatchWork& work, const detail::PatchCut& cut = kCut) {
        runPatchRound(surface, cut, scene.frame, work);
    }

    double squaredDistance(std::size_t s) const {
        const auto& [a, b, c] = surface.triangles[surface.sampleTriangle[s]];
        return detail::squaredDistanceToTriangle(
            surface.samples[s].point(), {surface.points[a], surface.points[b], surface.points[c]});
    }
    double sumOfSquares() const {
        double sum = 0;
        for (std::size_t s = 0; s < surface.samples.size(); ++s) sum += squaredDistance(s);
        return sum;
    }
};

}  // namespace

TEST(PatchRound, LeavesASoundSurfaceNearItsSamples) {
    RoundBall ball;
    ball.run({RoundBall::limits()});
    EXPECT_LT(ball.surface.triangleCount(), ball.surface.fineTriangles / 2);
    expectSound(meshOf(ball.surface));
    ASSERT_EQ(ball.surface.states.size(), ball.surface.points.size());
    ASSERT_EQ(ball.surface.quadrics.size(), ball.surface.points.size());
    EXPECT_EQ(meshOf(ball.surface).points.size(), ball.surface.points.size());  // none unused
    for (std::size_t s = 0; s < ball.surface.samples.size(); ++s) {
        ASSERT_LT(ball.surface.sampleTriangle[s], ball.surface.triangles.size());
        EXPECT_LE(std::sqrt(ball.squaredDistance(s)), RoundBall::kDistanceMm + kSampleRounding);
    }
}

TEST(PatchRound, KeepsWhatStraddlesTheCut) {
    RoundBall ball;
    using TrianglePlaces = std::array<double, 9>;
    const auto keys = [](const SimplifiedSurface& surface, bool onlyStraddling) {
        std::set<TrianglePlaces> all;
        for (const auto& t : surface.triangles) {
            std::set<std::array<double, 3>> cubes;
            TrianglePlaces key;
            for (int c = 0; c < 3; ++c) {
                const Vec3& p = surface.points[t[c]];
                cubes.insert({std::floor((p.x - 12) / 16), std::floor((p.y - 12) / 16),
                              std::floor((p.z - 12) / 16)});
                for (int a = 0; a < 3; ++a) key[3 * c + a] = p[a];
            }
            if (!onlyStraddling || cubes.size() > 1) all.insert(key);
        }
        return all;
    };
    const std::set<TrianglePlaces> straddling = keys(ball.surface, true);
    ball.run({RoundBall::limits()});
    const std::set<TrianglePlaces> after = keys(ball.surface, false);
    EXPECT_GT(straddling.size(), 100U);
    EXPECT_TRUE(std::includes(after.begin(), after.end(), straddling.begin(), straddling.end()));
}

TEST(PatchRound, MakesNoMoreCollapsesThanAsked) {
    for (const std::int64_t most : {0, 1, 100}) {
        RoundBall ball;
        PatchWork work{RoundBall::limits()};
        work.mostCollapses = most;
        ball.run(work);
        // two triangles each; the patches are large enough for their shares
        EXPECT_EQ(ball.surface.fineTriangles - ball.surface.triangleCount(), 2 * most);
    }
}

TEST(PatchRound, LendsAPatchOfAllTheSamplesAndGetsThemBack) {
    // the second cut has the ball in one cube, and a vertex without triangles in another: so its
    // samples are copied
    const detail::PatchCut cut{256, {-100, -100, -100}};
    RoundBall lent, copied;
    copied.surface.points.push_back(copied.scene.frame.fromIndex({1000, 0, 0}));
    copied.surface.states.push_back(detail::Patch::State::Final);
    copied.surface.quadrics.emplace_back();
    ASSERT_TRUE(detail::PatchGroups(lent.surface, cut, lent.scene.frame).isOne());
    ASSERT_FALSE(detail::PatchGroups(copied.surface, cut, copied.scene.frame).isOne());
    const std::vector<detail::Sample> before = lent.surface.samples;
    PatchWork work{RoundBall::limits()};
    work.fits = true;
    lent.run(work, cut);
    copied.run(work, cut);
    EXPECT_EQ(lent.surface.points, copied.surface.points);
    EXPECT_EQ(lent.surface.triangles, copied.surface.triangles);
    EXPECT_EQ(lent.surface.sampleTriangle, copied.surface.sampleTriangle);
    ASSERT_EQ(lent.surface.samples.size(), before.size());
    for (std::size_t s = 0; s < before.size(); ++s) {
        EXPECT_EQ(lent.surface.samples[s].position, before[s].position);
    }
}

TEST(PatchRound, BringsVerticesNearerToTheSamples) {
    RoundBall ball;
    ball.run({RoundBall::limits()});
    const std::int64_t count = ball.surface.triangleCount();
    const double before = ball.sumOfSquares();
    PatchWork work{RoundBall::limits()};
    work.collapses = false;
    work.fits = true;
    ball.run(work);
    EXPECT_EQ(ball.surface.triangleCount(), count);
    EXPECT_LT(ball.sumOfSquares(), 0.9 * before);
    expectSound(meshOf(ball.surface));
}

TEST(PatchRound, LeavesVerticesThatAreFinal) {
    RoundBall ball;
    ball.surface.states.assign(ball.surface.points.size(), detail::Patch::State::Final);
    const auto points = ball.surface.points;
    ball.run({RoundBall::limits()});
    EXPECT_EQ(ball.surface.points, points);
}

}  // namespace adaptiso::testing
