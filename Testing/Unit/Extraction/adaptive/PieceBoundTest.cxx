#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Surfaces.h"
#include "adaptiso/SurfaceProof/PieceBound.h"

namespace adaptiso::testing {
namespace {

using detail::PieceBound;

/// A bound that has to grow grows by a hundredth more, and cuts are not placed exactly.
constexpr double kLoose = 1.05;

double distanceToAny(const std::vector<Corners>& triangles, const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Corners& t : triangles) {
        least = std::min(least, detail::squaredDistanceToTriangle(p, t));
    }
    return std::sqrt(least);
}

/// The largest distance of points of a piece, a grid of them.
double largestDistance(const std::vector<Corners>& triangles, const Corners& piece) {
    constexpr int kSteps = 24;
    double largest = 0;
    for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; i + j <= kSteps; ++j) {
            const double u = 1.0 * i / kSteps, v = 1.0 * j / kSteps;
            largest = std::max(largest, distanceToAny(triangles, (1 - u - v) * piece[0] +
                                                                     u * piece[1] + v * piece[2]));
        }
    }
    return largest;
}

}  // namespace

TEST(PieceBound, IsTheDistanceOfAParallelPiece) {
    PieceBound bound;
    bound.nearby() = {{Vec3{0, 0, 0}, Vec3{9, 0, 0}, Vec3{0, 9, 0}}};
    bound.include({Vec3{1, 1, 0.5}, Vec3{2, 1, 0.5}, Vec3{1, 2, 0.5}});
    EXPECT_GE(bound.boundMm(), 0.5);
    EXPECT_LE(bound.boundMm(), kLoose * 0.5);
    // a piece nearer than that changes nothing, one farther off does
    const double before = bound.boundMm();
    bound.include({Vec3{1, 1, -0.2}, Vec3{2, 1, 0.1}, Vec3{1, 2, 0}});
    EXPECT_EQ(bound.boundMm(), before);
    bound.include({Vec3{1, 1, 0.1}, Vec3{2, 1, 0.1}, Vec3{3, -4, 0}});  // one corner 4 aside
    EXPECT_GE(bound.boundMm(), 4);
    EXPECT_LE(bound.boundMm(), kLoose * 4);
}

TEST(PieceBound, NeedsToBeNoTighterThanEnough) {
    PieceBound bound(0.7);
    bound.nearby() = {{Vec3{0, 0, 0}, Vec3{9, 0, 0}, Vec3{0, 9, 0}}};
    bound.include({Vec3{1, 1, 0.5}, Vec3{2, 1, 0.5}, Vec3{1, 2, 0.5}});
    EXPECT_DOUBLE_EQ(bound.boundMm(), 0.7);
    EXPECT_DOUBLE_EQ(bound.squaredBound(), 0.7 * 0.7);
}

TEST(PieceBound, IsTheDistanceOfAPieceAcrossARidge) {
    // a roof of two triangles with its ridge along x at height 1, and a piece under the ridge
    PieceBound bound;
    bound.nearby() = {{Vec3{-10, -5, 0}, Vec3{10, -5, 0}, Vec3{0, 0, 1}},
                      {Vec3{-10, 5, 0}, Vec3{0, 0, 1}, Vec3{10, 5, 0}}};
    bound.include({Vec3{0, -0.5, 0.7}, Vec3{0.2, 0.5, 0.7}, Vec3{-0.2, 0.5, 0.7}});
    // farthest at y = 0, where the roof is highest: under it by 0.3, times the slope's cosine
    const double exact = 0.3 * 5 / std::sqrt(26.0);
    EXPECT_GE(bound.boundMm(), exact);
    EXPECT_LE(bound.boundMm(), kLoose * exact);
}

TEST(PieceBound, SaysWhatLiesBeyondALimit) {
    PieceBound bound(0.1);
    bound.nearby() = {{Vec3{50, 0, 0}, Vec3{59, 0, 0}, Vec3{50, 9, 0}},
                      {Vec3{0, 0, 0}, Vec3{9, 0, 0}, Vec3{0, 9, 0}}};
    const Corners piece{Vec3{1, 1, 0}, Vec3{2, 1, 0}, Vec3{1, 2, 3}};  // one corner 3 above
    double farthestMm = 0;
    const auto far = bound.includeWithin(2.9, piece, farthestMm);
    ASSERT_TRUE(far);
    EXPECT_EQ(far->point, (Vec3{1, 2, 3}));
    EXPECT_EQ(far->onOther, (Vec3{1, 2, 0}));
    EXPECT_TRUE(far->hasNearest);
    EXPECT_EQ(far->nearest, 1U);
    EXPECT_GE(farthestMm, 3);
    EXPECT_EQ(bound.boundMm(), 0.1);  // as before
    EXPECT_FALSE(bound.includeWithin(3, piece, farthestMm));
    EXPECT_EQ(bound.boundMm(), 3);
}

TEST(PieceBound, IsInfiniteWhereNoTriangleIsNear) {
    PieceBound bound(1);
    double worst = 0;
    const Corners piece{Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 3, 0}};
    EXPECT_FALSE(bound.isWithin(piece));
    bound.include(piece);
    EXPECT_EQ(bound.boundMm(), std::numeric_limits<double>::infinity());
    const auto far = PieceBound(1).includeWithin(2, piece, worst);
    ASSERT_TRUE(far);
    EXPECT_EQ(far->point, (Vec3{1, 1, 0}));
    EXPECT_FALSE(far->hasNearest);
    EXPECT_EQ(worst, std::numeric_limits<double>::infinity());
}

// Certain, and not much more than what is true.
TEST(PieceBound, HoldsForAllPointsOfThePieces) {
    std::mt19937 random(11);
    double worst = 1;
    for (int n = 0; n < 300; ++n) {
        PieceBound bound;
        for (int t = 0; t < 1 + n % 6; ++t) {
            bound.nearby().push_back(
                {randomPoint(random), randomPoint(random), randomPoint(random)});
        }
        const Corners piece{randomPoint(random), randomPoint(random), randomPoint(random)};
        const double largest = largestDistance(bound.nearby(), piece);
        bound.include(piece);
        ASSERT_GE(bound.boundMm(), largest * (1 - 1e-12)) << n;
        worst = std::max(worst, bound.boundMm() / largest);
        // what is said to lie within a distance does
        PieceBound part(0.8 * largest), more(1.2 * largest);
        part.nearby() = more.nearby() = bound.nearby();
        ASSERT_FALSE(part.isWithin(piece)) << n;
        if (more.isWithin(piece)) continue;
        ASSERT_GT(bound.nearby().size(), 1U) << n;  // of one triangle the corners tell all
    }
    // the grid misses the farthest point by a 24th of a side; cuts end after a few
    EXPECT_LT(worst, 1.3);
}

}  // namespace adaptiso::testing
