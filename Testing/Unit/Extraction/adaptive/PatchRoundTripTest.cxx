#include <gtest/gtest.h>

#include "PatchedBall.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;
using detail::SimplifiedSurface;

}  // namespace

TEST(PatchGroups, PutBackWhatTheyTook) {
    PatchedBall ball;
    detail::SimplifiedSurface after = ball.surface;
    std::vector<std::uint32_t> mergedInto;
    for (std::size_t n = 0; n < ball.groups.count(); ++n) {
        const Patch patch = ball.groups.take(n, ball.scratch);
        ball.groups.putBack(n, patch, after, mergedInto);
    }
    EXPECT_EQ(after.points, ball.surface.points);
    EXPECT_EQ(after.triangles, ball.surface.triangles);
    EXPECT_EQ(after.sampleTriangle, ball.surface.sampleTriangle);
    EXPECT_EQ(after.states, ball.surface.states);
}

TEST(PatchGroups, PutBackWhatChangedAndNothingElse) {
    PatchedBall ball;
    detail::SimplifiedSurface after = ball.surface;
    std::vector<std::uint32_t> mergedInto;
    std::size_t n = 0;
    while (ball.groups.triangleCount(n) < 20) ++n;
    Patch patch = ball.groups.take(n, ball.scratch);
    const Vec3 before = patch.points[3];
    patch.points[3] += {0.25, 0, 0};
    patch.states[3] = Patch::State::Fitted;
    const Key gone = keyOf(patch, 7);
    patch.triangles[7].fill(Patch::kGone);
    ball.groups.putBack(n, patch, after, mergedInto);
    int moved = 0, removed = 0;
    for (std::size_t v = 0; v < after.points.size(); ++v) {
        if (after.points[v] == ball.surface.points[v]) continue;
        ++moved;
        EXPECT_EQ(ball.surface.points[v], before);
        EXPECT_EQ(after.points[v], before + (Vec3{0.25, 0, 0}));
        EXPECT_EQ(after.states[v], Patch::State::Fitted);
    }
    for (std::uint32_t t = 0; t < after.triangles.size(); ++t) {
        if (after.triangles[t] == ball.surface.triangles[t]) continue;
        ++removed;
        EXPECT_EQ(ball.key(t), gone);
        EXPECT_EQ(after.triangles[t][0], SimplifiedSurface::kGone);
    }
    EXPECT_EQ(moved, 1);
    EXPECT_EQ(removed, 1);
}

}  // namespace adaptiso::testing
