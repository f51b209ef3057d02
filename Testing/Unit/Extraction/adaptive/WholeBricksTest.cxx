#include <gtest/gtest.h>

#include <algorithm>

#include "NoisyScenes.h"
#include "adaptive/mesh/WholeBricks.h"

namespace adaptiso::testing {
namespace {

using detail::SimplifiedSurface;
using detail::WholeBricks;

std::vector<bool> wholeOnes(const SimplifiedSurface& surface, const Scene& scene) {
    const WholeBricks whole(surface, scene.bricks, scene.frame);
    std::vector<bool> is;
    for (std::int64_t b = 0; b < scene.bricks.count(); ++b) is.push_back(whole.isWhole(b));
    return is;
}

/// A triangle whose middle lies in a brick (along x), away from its walls.
std::uint32_t triangleWithin(const SimplifiedSurface& surface, double low) {
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        double least = 1e9, most = -1e9;
        for (const std::uint32_t v : surface.triangles[t]) {
            least = std::min(least, surface.points[v].x);
            most = std::max(most, surface.points[v].x);
        }
        if (least > low + 10 && most < low + 20) return t;
    }
    ADD_FAILURE() << "no triangle there";
    return 0;
}

}  // namespace

TEST(WholeBricks, AreAllOfNoise) {
    for (const Border border : {Border::Open, Border::Closed}) {
        const Scene scene(whiteNoise({70, 20, 20}, 3), 0, border);
        const SimplifiedSurface surface = firstRoundOf(scene);
        EXPECT_EQ(surface.triangleCount(), surface.fineTriangles);
        const WholeBricks whole(surface, scene.bricks, scene.frame);
        EXPECT_TRUE(whole.areAll());
        for (std::int64_t b = 0; b < scene.bricks.count(); ++b) EXPECT_TRUE(whole.isWhole(b)) << b;
        for (std::uint64_t t = 0; t < surface.triangles.size(); ++t) {
            ASSERT_TRUE(whole.isFine(t)) << t;
        }
    }
}

TEST(WholeBricks, AreNoneOfABall) {
    const Scene scene = ballScene();
    const SimplifiedSurface surface = firstRoundOf(scene);
    const WholeBricks whole(surface, scene.bricks, scene.frame);
    EXPECT_FALSE(whole.isAny());
    EXPECT_FALSE(whole.areAll());
    EXPECT_FALSE(whole.isWhole(0));
    EXPECT_FALSE(whole.isFine(0));
}

TEST(WholeBricks, AreThoseOfNoiseBesideSmoothOnes) {
    const Scene scene(noiseBesideSmooth({70, 20, 20}, {}, 5), 0, Border::Open);
    ASSERT_EQ(scene.bricks.count(), 3);
    const SimplifiedSurface surface = firstRoundOf(scene);
    EXPECT_EQ(wholeOnes(surface, scene), (std::vector{true, false, false}));
    EXPECT_FALSE(WholeBricks(surface, scene.bricks, scene.frame).areAll());
}

// Numbers of triangles and vertices may change, and their order; nothing else.
TEST(WholeBricks, AreTheSameUnderOtherNumbers) {
    const Scene scene(whiteNoise({70, 20, 20}, 3), 0, Border::Open);
    SimplifiedSurface surface = firstRoundOf(scene);
    std::reverse(surface.triangles.begin(), surface.triangles.end());
    std::reverse(surface.points.begin(), surface.points.end());
    const auto last = static_cast<std::uint32_t>(surface.points.size() - 1);
    for (auto& t : surface.triangles) {
        for (std::uint32_t& v : t) v = last - v;
    }
    EXPECT_TRUE(WholeBricks(surface, scene.bricks, scene.frame).areAll());
}

TEST(WholeBricks, AreNotWhereAnythingChanged) {
    const Scene scene(whiteNoise({70, 20, 20}, 3), 0, Border::Open);
    const SimplifiedSurface before = firstRoundOf(scene);
    ASSERT_EQ(scene.bricks.count(), 3);
    const std::uint32_t t = triangleWithin(before, 32);
    const std::vector<bool> withoutMiddle{true, false, true};
    {
        SCOPED_TRACE("a vertex moves by a unit in the last place");
        SimplifiedSurface surface = before;
        double& x = surface.points[surface.triangles[t][1]].x;
        x = std::nextafter(x, 1e9);
        EXPECT_EQ(wholeOnes(surface, scene), withoutMiddle);
    }
    {
        SCOPED_TRACE("a triangle is turned round");
        SimplifiedSurface surface = before;
        std::swap(surface.triangles[t][0], surface.triangles[t][1]);
        EXPECT_EQ(wholeOnes(surface, scene), withoutMiddle);
    }
    {
        SCOPED_TRACE("a triangle goes");
        SimplifiedSurface surface = before;
        surface.triangles.erase(surface.triangles.begin() + t);
        EXPECT_EQ(wholeOnes(surface, scene), withoutMiddle);
    }
    {
        SCOPED_TRACE("a triangle comes twice");
        SimplifiedSurface surface = before;
        surface.triangles.push_back(surface.triangles[t]);
        EXPECT_EQ(wholeOnes(surface, scene), withoutMiddle);
    }
    {
        SCOPED_TRACE("a triangle in place of another");
        SimplifiedSurface surface = before;
        surface.triangles[t == 0 ? 1 : 0] = surface.triangles[t];
        EXPECT_FALSE(wholeOnes(surface, scene)[1]);
    }
    {
        SCOPED_TRACE("a triangle of no brick comes");
        SimplifiedSurface surface = before;
        const auto first = static_cast<std::uint32_t>(surface.points.size());
        for (const Vec3& p : {Vec3{500, 0, 0}, Vec3{501, 0, 0}, Vec3{500, 1, 0}}) {
            surface.points.push_back(p);
        }
        surface.triangles.push_back({first, first + 1, first + 2});
        const WholeBricks whole(surface, scene.bricks, scene.frame);
        EXPECT_FALSE(whole.areAll());
        EXPECT_FALSE(whole.isFine(surface.triangles.size() - 1));
        EXPECT_TRUE(whole.isWhole(1));
    }
}

}  // namespace adaptiso::testing
