#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "Surfaces.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptive/proof/BrickProof.h"

namespace adaptiso::testing {
namespace {

using detail::BrickBound;
using detail::BrickProof;
using detail::ProofScope;

constexpr double kNoLimit = std::numeric_limits<double>::max();

/// A ball's full surface in eight bricks, and what is proved of it.
struct Ball {
    Scene scene = ballScene();
    detail::SimplifiedSurface surface = scene.fullSurface();
    ProofScope scope;

    std::vector<BrickBound> prove(double limitMm = kNoLimit) const {
        const detail::SurfaceLookup lookup(surface, scene.bricks, scene.frame);
        detail::SampleNumbers numbers(scene.bricks);
        const detail::WholeBricks none;
        if (!scope.blocks.empty()) {  // learnt from the whole
            const ProofScope all;
            BrickProof whole(surface, lookup, none, *scene.sampler, all, numbers, 0.01, limitMm);
            for (std::int64_t b = 0; b < scene.bricks.count(); ++b) whole.prove(b);
        }
        BrickProof proof(surface, lookup, none, *scene.sampler, scope, numbers, 0.01, limitMm);
        std::vector<BrickBound> bounds;
        for (std::int64_t b = 0; b < scene.bricks.count(); ++b) bounds.push_back(proof.prove(b));
        return bounds;
    }
};

double provedArea(const std::vector<BrickBound>& bounds) {
    double area = 0;
    for (const BrickBound& bound : bounds) area += bound.provedArea;
    return area;
}

}  // namespace

TEST(BrickProof, ProvesEveryPartOfTheSurfaceInOneBrick) {
    const Ball ball;
    const std::vector<BrickBound> bounds = ball.prove();
    ASSERT_EQ(bounds.size(), 8U);
    EXPECT_NEAR(provedArea(bounds), surfaceArea(meshOf(ball.surface)), 1e-6);
    for (const BrickBound& bound : bounds) {
        EXPECT_GT(bound.provedArea, 50);  // about an eighth of 615 mm2
        EXPECT_LE(bound.provedMm, 0.011);
        EXPECT_EQ(bound.farthestMm, 0);
    }
}

TEST(BrickProof, ProvesLargeTrianglesToo) {
    Ball ball;
    // a box of twelve triangles around the ball: its corners lie far off
    const TriangleMesh box = [] {
        TriangleMesh mesh;
        for (int i = 0; i < 8; ++i) {
            mesh.points.push_back(kBallMiddle + 8.0 * Vec3{(i & 1) != 0 ? 1.0 : -1.0,
                                                           (i & 2) != 0 ? 1.0 : -1.0,
                                                           (i & 4) != 0 ? 1.0 : -1.0});
        }
        for (const auto& [a, b, c, d] : {std::array{0, 2, 3, 1},
                                         {4, 5, 7, 6},
                                         {0, 1, 5, 4},
                                         {2, 6, 7, 3},
                                         {0, 4, 6, 2},
                                         {1, 3, 7, 5}}) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
        return mesh;
    }();
    ball.surface.state() = surfaceOf(box).state();
    ball.surface.sampleTriangle.assign(ball.surface.samples.size(), 0);
    const std::vector<BrickBound> bounds = ball.prove();
    EXPECT_NEAR(provedArea(bounds), 6 * 16 * 16, 1e-6);
    double most = 0;
    for (const BrickBound& bound : bounds) most = std::max(most, bound.provedMm);
    // from a corner of the box to the ball: the half diagonal less the radius
    const double exact = 8 * std::sqrt(3.0) - kBallRadius;
    EXPECT_GE(most, exact - 0.04);
    EXPECT_LE(most, 1.1 * exact);
}

TEST(BrickProof, ProvesWhatItsScopeAsksFor) {
    Ball ball;
    ball.scope.isKnown.assign(ball.surface.triangles.size(), 1);
    ball.scope.blocks.assign(ball.scene.bricks.grid().blockCount(), false);
    for (const BrickBound& bound : ball.prove()) {
        EXPECT_EQ(bound.provedArea, 0);
        EXPECT_EQ(bound.provedMm, 0);
    }
    ball.scope.isKnown[5] = 0;
    const auto& [a, b, c] = ball.surface.triangles[5];
    const auto& p = ball.surface.points;
    EXPECT_NEAR(provedArea(ball.prove()), 0.5 * norm(areaVector2(p[a], p[b], p[c])), 1e-9);
}

TEST(BrickProof, NotesPlacesOnceWithTheNearestPoint) {
    Ball ball;
    for (Vec3& p : ball.surface.points) {
        if (p.z > kBallMiddle.z + 6) p.z += 1;
    }
    std::size_t places = 0;
    for (const BrickBound& bound : ball.prove(0.4)) {
        EXPECT_LE(bound.provedMm, 0.4);
        for (const auto& place : bound.beyondLimit) {
            ++places;
            EXPECT_GT(place.point().z, kBallMiddle.z + 4);
            EXPECT_GE(bound.farthestMm, std::sqrt(place.squaredDistance()) * (1 - 1e-9));
            if (place.isOfFine) continue;
            ASSERT_LT(place.triangle, ball.surface.triangles.size());
            // the place lies on its triangle
            const auto& t = ball.surface.triangles[place.triangle];
            EXPECT_NEAR(
                detail::squaredDistanceToTriangle(
                    place.onSimplified, {ball.surface.points[t[0]], ball.surface.points[t[1]],
                                         ball.surface.points[t[2]]}),
                0, 1e-12);
        }
    }
    EXPECT_GT(places, 10U);
}

}  // namespace adaptiso::testing
