#include <gtest/gtest.h>

#include <cmath>

#include "Surfaces.h"
#include "adaptiso/SurfaceProof/Quadric.h"

namespace adaptiso::testing {
namespace {

using detail::minimize;
using detail::Quadric;

/// Of the plane through a point with a unit normal.
Quadric planeQuadric(const Vec3& point, const Vec3& unitNormal, double area = 1) {
    return Quadric::ofTriangle(2 * area * unitNormal, point);
}

}  // namespace

TEST(Quadric, IsTheAreaTimesTheSquaredDistanceToThePlane) {
    std::mt19937 random(1);
    for (int n = 0; n < 1000; ++n) {
        const Vec3 a = randomPoint(random), b = randomPoint(random), c = randomPoint(random),
                   p = randomPoint(random);
        const Vec3 area2 = areaVector2(a, b, c);
        const double area = 0.5 * norm(area2), height = dot(normalized(area2), p - a);
        const Quadric q = Quadric::ofTriangle(area2, b);
        EXPECT_NEAR(q.at(p), area * height * height, 1e-12);
        EXPECT_NEAR(q.weight(), area, 1e-12);
    }
}

TEST(Quadric, AddsUp) {
    const Quadric p = planeQuadric({0, 0, 1}, {0, 0, 1}, 2),
                  q = planeQuadric({3, 0, 0}, {1, 0, 0}, 5);
    const Vec3 at{1, 2, 3};
    EXPECT_DOUBLE_EQ((p + q).at(at), p.at(at) + q.at(at));
    EXPECT_DOUBLE_EQ((p + q).at(at), 2 * 4 + 5 * 4);
    EXPECT_DOUBLE_EQ((p + q).weight(), 7);
}

TEST(Quadric, IsNothingOfATriangleWithoutArea) {
    const Quadric q = Quadric::ofTriangle({}, {1, 2, 3});
    EXPECT_EQ(q.weight(), 0);
    EXPECT_EQ(q.at({5, 5, 5}), 0);
}

TEST(Quadric, IsLeastAtACorner) {
    const Vec3 corner{1, 2, 3};
    Quadric q = planeQuadric(corner, {1, 0, 0}) + planeQuadric(corner, normalized({1, 1, 0}), 3);
    q += planeQuadric(corner, normalized({1, 1, 1}), 0.5);
    const auto least = minimize(q, {1.4, 1.8, 3.3}, 1e-12);
    EXPECT_NEAR(norm(least.point - corner), 0, 1e-9);
    EXPECT_NEAR(least.error, 0, 1e-12);
}

TEST(Quadric, IsLeastHalfwayBetweenTwoFloors) {
    // heights 0 and 2, the upper one three times as large: at 1.5, with 1 x 1.5^2 + 3 x 0.5^2
    const Quadric q = planeQuadric({0, 0, 0}, {0, 0, 1}) + planeQuadric({0, 0, 2}, {0, 0, 1}, 3);
    const auto least = minimize(q, {7, 8, 0}, 1e-9);
    EXPECT_NEAR(norm(least.point - Vec3{7, 8, 1.5}), 0, 1e-6);
    EXPECT_NEAR(least.error, 3, 1e-6);
}

TEST(Quadric, StaysBesideTheGuessOnAFlatPatch) {
    const Quadric q = planeQuadric({0, 0, 1}, {0, 0, 1}, 4);
    for (const double height : {1.0, 1.5, -2.0}) {
        const auto least = minimize(q, {3, -4, height}, 1e-9);
        EXPECT_NEAR(norm(least.point - Vec3{3, -4, 1}), 0, 1e-6);
        EXPECT_NEAR(least.error, 0, 1e-12);
    }
}

TEST(Quadric, StaysBesideTheGuessAlongAnEdge) {
    const Quadric q = planeQuadric({0, 0, 1}, {0, 0, 1}) + planeQuadric({0, 2, 0}, {0, 1, 0});
    const auto least = minimize(q, {5, 2.5, 0.5}, 1e-9);
    EXPECT_NEAR(norm(least.point - Vec3{5, 2, 1}), 0, 1e-6);
}

TEST(Quadric, SaysTheErrorOfThePointItGives) {
    std::mt19937 random(2);
    for (int n = 0; n < 500; ++n) {
        Quadric q;
        for (int planes = 1 + n % 5; planes > 0; --planes) {
            q += planeQuadric(randomPoint(random), normalized(randomPoint(random)), 0.5 * planes);
        }
        const Vec3 guess = randomPoint(random);
        const auto least = minimize(q, guess, 1e-3);
        ASSERT_NEAR(least.error, q.at(least.point), 1e-9);
        ASSERT_LE(least.error, q.at(guess) + 1e-12);
        // no other place is better, when the way from the guess counts by its stiffness
        const auto cost = [&](const Vec3& p) {
            return q.at(p) + 1e-3 * q.weight() * squaredNorm(p - guess);
        };
        for (int other = 0; other < 10; ++other) {
            const Vec3 step = randomPoint(random, other < 5 ? 1 : 0.01);
            ASSERT_LE(cost(least.point), cost(least.point + step) + 1e-12);
        }
    }
}

TEST(StoredQuadric, LosesLittleFarFromTheOrigin) {
    std::mt19937 random(3);
    const Vec3 far{500, -800, 1200};
    for (int n = 0; n < 200; ++n) {
        const Vec3 origin = far + randomPoint(random);
        Quadric q;
        for (int planes = 0; planes < 6; ++planes) {
            q += planeQuadric(far + randomPoint(random), normalized(randomPoint(random)));
        }
        const Quadric back = detail::StoredQuadric::of(q, origin).about(origin);
        const Vec3 p = origin + randomPoint(random);
        // floats have 24 bits, and the terms are about 10; doubles lose 1e-16 of 6 x 1500^2
        EXPECT_NEAR(back.at(p), q.at(p), 1e-5);
    }
}

}  // namespace adaptiso::testing
