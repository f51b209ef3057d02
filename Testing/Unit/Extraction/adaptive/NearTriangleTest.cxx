#include <gtest/gtest.h>

#include <cmath>

#include "Surfaces.h"
#include "adaptiso/SurfaceProof/NearTriangle.h"

namespace adaptiso::testing {

TEST(NearTriangle, TellsWhatTheDistanceTells) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> squared(0.001, 2);
    int within = 0;
    for (int n = 0; n < 20000; ++n) {
        Corners t{randomPoint(random), randomPoint(random), randomPoint(random)};
        if (n % 10 == 0) t[2] = t[0] + 0.3 * (t[1] - t[0]) + 1e-9 * t[2];  // next to flat
        const Vec3 p = randomPoint(random);
        const double limit = squared(random), distance = detail::squaredDistanceToTriangle(p, t);
        if (std::abs(distance - limit) < 1e-6) continue;
        const detail::NearTriangle near(t, limit);
        EXPECT_EQ(near.has(p), distance < limit) << n;
        within += static_cast<int>(near.has(p));
    }
    EXPECT_GT(within, 5000);
    EXPECT_LT(within, 15000);
}

// A side is told by the corner at which it begins.
TEST(NearTriangle, KnowsTheSideThatAPointLiesBeyond) {
    const Corners t{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
    EXPECT_EQ(detail::sideTowards({1, 1, 9}, t), -1);
    EXPECT_EQ(detail::sideTowards({1, -1, 9}, t), 0);
    EXPECT_EQ(detail::sideTowards({3, 3, -9}, t), 1);
    EXPECT_EQ(detail::sideTowards({-1, 1, 0}, t), 2);
}

}  // namespace adaptiso::testing
