#include <gtest/gtest.h>

#include <cmath>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptive/collapse/ChangedStar.h"

namespace adaptiso::testing {
namespace {

using detail::ChangedStar;
using detail::Refusal;

/// The vertex in the middle of a square of 2 x 2 cells, 1 mm each, and its six triangles.
struct Middle {
    detail::Patch patch = patchOf(planeMesh(2, 2));
    ChangedStar changed;

    Middle() {
        const detail::PatchTopology topology(patch);
        for (std::uint32_t v = 0; v < patch.points.size(); ++v) {
            if (!topology.isMovable(v)) continue;
            EXPECT_TRUE(topology.starOf(v, changed.star));
        }
    }
    Refusal shape(const Vec3& vertex, double leastAngleDeg = 0) {
        changed.vertex = vertex;
        return shapeStar(patch, {leastAngleDeg}, changed);
    }
};

}  // namespace

TEST(ChangedStar, KnowsItsTriangles) {
    Middle middle;
    ASSERT_EQ(middle.shape({1.2, 0.9, 0.3}), Refusal::None);
    EXPECT_TRUE(middle.changed.isGraph);
    const auto& [star, vertex, wedges, isGraph, normal] = middle.changed;
    EXPECT_NEAR(norm(normal), 1, 1e-12);
    ASSERT_EQ(star.count, 6);
    for (int i = 0; i < star.count; ++i) {
        const ChangedStar::Wedge& w = wedges[i];
        const Vec3 e1 = middle.patch.points[star.ring[i]] - vertex,
                   e2 = middle.patch.points[star.ring[(i + 1) % 6]] - vertex;
        EXPECT_EQ(w.e1, e1);
        EXPECT_EQ(w.e2, e2);
        EXPECT_DOUBLE_EQ(w.a11, dot(e1, e1));
        EXPECT_DOUBLE_EQ(w.a12, dot(e1, e2));
        EXPECT_DOUBLE_EQ(w.a22, dot(e2, e2));
        EXPECT_NEAR(w.inverse * squaredNorm(cross(e1, e2)), 1, 1e-12);
    }
}

TEST(ChangedStar, IsRefusedWhereATriangleIsFlat) {
    Middle middle;
    EXPECT_EQ(middle.shape({0, 1, 0}), Refusal::Flat);  // on the ring
    EXPECT_EQ(middle.shape({1e-8, 1, 0}), Refusal::Flat);
    EXPECT_EQ(middle.shape({0.1, 1, 0}), Refusal::None);
}

TEST(ChangedStar, IsRefusedWhereATriangleTurnsOver) {
    Middle middle;
    EXPECT_EQ(middle.shape({-0.5, 1, 0}), Refusal::Turned);
    EXPECT_EQ(middle.shape({1, 1, 20}), Refusal::Turned);  // a spike: its sides stand upright
    EXPECT_EQ(middle.shape({1, 1, 0.5}), Refusal::None);
}

TEST(ChangedStar, IsRefusedWhereACornerIsTooSharp) {
    Middle middle;
    // the triangle with the ring's (0, 1) and (0, 0) has sides of 0.2 and 1: atan(0.2), 11 degrees
    EXPECT_EQ(middle.shape({0.2, 1, 0}), Refusal::None);
    EXPECT_EQ(middle.shape({0.2, 1, 0}, 5), Refusal::None);
    EXPECT_EQ(middle.shape({0.2, 1, 0}, 30), Refusal::SharpCorner);
    EXPECT_EQ(middle.shape({1, 1, 0}, 40), Refusal::None);
}

TEST(ChangedStar, MayHaveASharpCornerWhereTheOneBeforeWasSharper) {
    Middle middle;
    const std::uint32_t vertex = middle.changed.star.apex[0];
    middle.patch.points[vertex] = {0.05, 1, 0};
    EXPECT_EQ(middle.shape({0.2, 1, 0}, 30), Refusal::None);
    EXPECT_EQ(middle.shape({0.04, 1, 0}, 30), Refusal::SharpCorner);
}

TEST(ChangedStar, IsNoGraphWhereItGoesRoundItsVertexTwice) {
    // ten triangles in a spiral staircase of two turns about the z axis, each of them upright
    detail::Patch patch;
    ChangedStar changed;
    constexpr int kSteps = 10;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = 4 * M_PI * i / kSteps;
        patch.points.push_back({std::cos(angle), std::sin(angle), 0.05 * i});
        changed.star.ring[i] = static_cast<std::uint32_t>(i);
        changed.star.apex[i] = kSteps;
        changed.star.triangle[i] = static_cast<std::uint32_t>(i);
    }
    patch.points.push_back({0, 0, 0.2});
    changed.star.count = kSteps;
    changed.star.ring[kSteps] = changed.star.ring[0];
    changed.vertex = {0, 0, 0.25};
    ASSERT_EQ(shapeStar(patch, {}, changed), Refusal::None);
    EXPECT_FALSE(changed.isGraph);
}

// A vertex of the ring lies beyond the middle, seen along the star's normal: two triangles
// overhang.
TEST(ChangedStar, IsNoGraphWhereATriangleOverhangs) {
    const Vec3 centre{1, 1, 0};
    Middle middle;
    const detail::Star star = middle.changed.star;
    for (int i = 0; i < star.count; ++i) {
        Vec3& ring = middle.patch.points[star.ring[i]];
        const Vec3 before = ring;
        ring = centre + 0.2 * (before - centre) - Vec3{0, 0, 0.2};
        ASSERT_EQ(middle.shape(centre), Refusal::None);
        EXPECT_TRUE(middle.changed.isGraph) << i;
        ring = centre - 0.4 * (before - centre) - Vec3{0, 0, 0.2};
        ASSERT_EQ(middle.shape(centre), Refusal::None);  // no triangle turns: they were so before
        EXPECT_FALSE(middle.changed.isGraph) << i;
        ring = before;
    }
}

}  // namespace adaptiso::testing
