#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "Surfaces.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/proof/SurfaceLookup.h"

namespace adaptiso::testing {
namespace {

using detail::Brick;
using detail::Bricks;
using detail::SurfaceLookup;

/// A ball in eight bricks, and its triangles.
struct Ball {
    Scene scene = ballScene();
    detail::SimplifiedSurface surface = scene.fullSurface();
    SurfaceLookup lookup{surface, scene.bricks, scene.frame};

    /// How far a triangle's box lies from a brick, cells.
    double cellsFrom(std::int64_t brick, std::uint32_t t) const {
        const Corners c = lookup.cornersOf(t);
        const BoundingBox box =
            boxOf({lookup.latticeOf(c[0]), lookup.latticeOf(c[1]), lookup.latticeOf(c[2])});
        double farthest = 0;
        for (int a = 0; a < 3; ++a) {
            const auto low = static_cast<double>(scene.bricks[brick].low[a]);
            farthest =
                std::max({farthest, low - box.maximum[a], box.minimum[a] - low - Brick::kSide});
        }
        return farthest;
    }
};

}  // namespace

TEST(SurfaceLookup, HasTheTrianglesNearEachBrick) {
    const Ball ball;
    ASSERT_TRUE(ball.lookup.ofBrickHasAllWithin(1));
    ASSERT_FALSE(ball.lookup.ofBrickHasAllWithin(30));
    for (std::int64_t b = 0; b < ball.scene.bricks.count(); ++b) {
        const auto of = ball.lookup.ofBrick(b);
        EXPECT_TRUE(std::is_sorted(of.begin(), of.end()));
        EXPECT_LT(of.size(), ball.lookup.triangleCount() / 2);
        for (std::uint32_t t = 0; t < ball.lookup.triangleCount(); ++t) {
            const bool isListed = std::binary_search(of.begin(), of.end(), t);
            if (ball.cellsFrom(b, t) <= 1) {
                EXPECT_TRUE(isListed);
            }
            if (ball.cellsFrom(b, t) > 4) {
                EXPECT_FALSE(isListed);
            }
            bool isNear = false;
            ball.lookup.forEachBrickNear(t, [&](std::int64_t near) { isNear |= near == b; });
            EXPECT_EQ(isNear, isListed);
        }
    }
}

TEST(SurfaceLookup, FindsAllTrianglesNearAPiece) {
    const Ball ball;
    std::mt19937 random(1);
    for (int n = 0; n < 50; ++n) {
        const Vec3 p = kBallMiddle + randomPoint(random, 8);
        const Corners piece{p, p + randomPoint(random), p + randomPoint(random)};
        const double distance = 0.5 * (n % 5);
        std::set<std::uint32_t> found;
        ball.lookup.forEachNear(piece, distance, [&](std::uint32_t t) { found.insert(t); });
        EXPECT_LT(found.size(), ball.lookup.triangleCount() / 4);
        for (std::uint32_t t = 0; t < ball.lookup.triangleCount(); ++t) {
            for (const Vec3& corner : piece) {
                const double squared =
                    detail::squaredDistanceToTriangle(corner, ball.lookup.cornersOf(t));
                if (squared <= distance * distance) {
                    EXPECT_TRUE(found.contains(t)) << n;
                }
            }
        }
    }
}

// Triangles move, go and come: the lists of bricks, the half-edges and the tree are as if made
// anew.
TEST(SurfaceLookup, KnowsASurfaceAgainThatHasChanged) {
    Ball ball;
    detail::SimplifiedSurface& surface = ball.surface;
    std::mt19937 random(2);
    const Corners anywhere{Vec3{0, 0, 0}, Vec3{60, 0, 0}, Vec3{0, 60, 60}};
    ball.lookup.forEachNear(anywhere, 1, [](std::uint32_t) {});  // makes the tree
    for (int n = 0; n < 20; ++n) {
        std::vector<std::uint32_t> changed;
        const auto count = static_cast<std::uint32_t>(surface.triangles.size());
        for (int i = 0; i < 5; ++i) {
            changed.push_back(static_cast<std::uint32_t>(random() % count));
            surface.triangles[changed.back()] = surface.triangles[random() % count];
        }
        surface.triangles.resize(count + 3 - random() % 7);
        for (std::size_t t = count; t < surface.triangles.size(); ++t) {
            surface.triangles[t] = surface.triangles[t % 100];
        }
        changed.push_back(count + 5);  // came and went
        ball.lookup.update(changed);
        const SurfaceLookup anew(surface, ball.scene.bricks, ball.scene.frame);
        ASSERT_EQ(ball.lookup.triangleCount(), anew.triangleCount());
        for (std::int64_t b = 0; b < ball.scene.bricks.count(); ++b) {
            ASSERT_TRUE(std::ranges::equal(ball.lookup.ofBrick(b), anew.ofBrick(b))) << n;
        }
        for (std::uint32_t h = 0; h < 3 * anew.triangleCount(); ++h) {
            ASSERT_EQ(ball.lookup.walkable().twin(h), anew.walkable().twin(h)) << n;
        }
        const Corners piece{kBallMiddle, kBallMiddle + randomPoint(random, 9), kBallMiddle};
        std::set<std::uint32_t> found, expected;
        ball.lookup.forEachNear(piece, 1, [&](std::uint32_t t) { found.insert(t); });
        anew.forEachNear(piece, 1, [&](std::uint32_t t) { expected.insert(t); });
        ASSERT_EQ(found, expected) << n;
    }
}

TEST(SurfaceLookup, GivesEveryPointNearTheBricksToOneOfThem) {
    const Ball ball;
    const Bricks& bricks = ball.scene.bricks;
    for (std::int64_t b = 0; b < bricks.count(); ++b) {
        Vec3 in;
        for (int a = 0; a < 3; ++a) in[a] = static_cast<double>(bricks[b].low[a]) + 16.5;
        EXPECT_EQ(ball.lookup.brickFor(in), b);
        EXPECT_TRUE(ball.lookup.isWithinReach(b, {in, in, in}));
        EXPECT_FALSE(ball.lookup.isWithinReach(b, {in, in, in + Vec3{40, 0, 0}}));
    }
    EXPECT_EQ(ball.lookup.brickFor({-0.5, 16, 16}), bricks.at({0, 0, 0}));  // beside the first
    EXPECT_EQ(ball.lookup.brickFor({-20, 16, 16}), Bricks::kNone);
}

TEST(SurfaceLookup, KnowsTrianglesByNumberAndByVertices) {
    const Ball ball;
    const auto t = ball.surface.triangles[17];
    EXPECT_EQ(ball.lookup.cornersOf(17)[1], ball.surface.points[t[1]]);
    EXPECT_EQ(ball.lookup.point(t[1]), ball.surface.points[t[1]]);
    EXPECT_EQ(ball.lookup.walkable().find(t[1], t[2], t[0]), 17U);
}

TEST(SurfaceLookup, CallsAPieceSmallWhoseBoxFitsACell) {
    const Ball ball;
    EXPECT_TRUE(ball.lookup.isSmall({Vec3{1.5, 1, 1}, Vec3{2.4, 1.9, 1}, Vec3{1.5, 1, 1.9}}));
    EXPECT_FALSE(ball.lookup.isSmall({Vec3{1.5, 1, 1}, Vec3{2.6, 1.9, 1}, Vec3{1.5, 1, 1.9}}));
}

TEST(Quarter, CutsATriangleIntoFourEqualParts) {
    const Corners t{Vec3{0, 0, 0}, Vec3{4, 0, 1}, Vec3{1, 3, 2}};
    const Vec3 whole = areaVector2(t[0], t[1], t[2]);
    std::set<std::array<double, 3>> corners;
    for (const Corners& part : detail::quarter(t)) {
        EXPECT_NEAR(norm(areaVector2(part[0], part[1], part[2]) - 0.25 * whole), 0, 1e-12);
        for (const Vec3& p : part) corners.insert({p.x, p.y, p.z});
    }
    EXPECT_EQ(corners.size(), 6U);
}

}  // namespace adaptiso::testing
