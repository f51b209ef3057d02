#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ExactCrossing.h"
#include "Support/RandomPoints.h"
#include "adaptiso/MeshQuality/Certificate.h"

namespace adaptiso::testing {
namespace {

/// The corners in an order that begins with those that both triangles share.
/// \return how many they share
int orderByShared(std::array<int, 3>& s, std::array<int, 3>& t) {
    const auto isIn = [](const std::array<int, 3>& u) {
        return [&u](int v) { return std::find(u.begin(), u.end(), v) != u.end(); };
    };
    std::stable_partition(s.begin(), s.end(), isIn(t));
    std::stable_partition(t.begin(), t.end(), isIn(s));
    return static_cast<int>(std::count_if(s.begin(), s.end(), isIn(t)));
}

Corners cornersOf(const IntegerSoup& soup, const std::array<int, 3>& t) {
    IntegerSoup one{soup.points, {t}};
    return one.corners(0);
}

}  // namespace

TEST(Certificate, KnowsTheGapBetweenParallelTriangles) {
    const Corners low{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}},
        high{Vec3{0, 0, 0.5}, Vec3{0, 4, 0.5}, Vec3{4, 0, 0.5}};
    EXPECT_TRUE(areApart(low, high, 0.49));
    EXPECT_FALSE(areApart(low, high, 0.51));
    const Corners aside{Vec3{5, 0, 0}, Vec3{9, 0, 0}, Vec3{5, 4, 0}};  // in one plane
    EXPECT_TRUE(areApart(low, aside, 0.9));
    EXPECT_FALSE(areApart(low, aside, 1.1));
}

// A plane lies between two convex bodies if they do not meet (separating axis theorem), so among
// triangles in general position the proof is found exactly where nothing crosses.
TEST(Certificate, IsFoundWhereTrianglesAreApart) {
    std::mt19937 random(1);
    int apart = 0, crossed = 0;
    for (int n = 0; n < 5000; ++n) {
        const IntegerSoup soup = randomSoup(random, 30, 2, 50);
        if (std::any_of(soup.triangles[0].begin(), soup.triangles[0].end(), [&](int v) {
                return std::count(soup.triangles[1].begin(), soup.triangles[1].end(), v) > 0;
            })) {
            continue;
        }
        const std::optional<bool> cross = soup.cross(0, 1);
        if (!cross) continue;
        ASSERT_EQ(areApart(soup.corners(0), soup.corners(1), 1e-9), !*cross) << n;
        (*cross ? crossed : apart)++;
    }
    EXPECT_GT(apart, 1000);
    EXPECT_GT(crossed, 100);
}

TEST(Certificate, IsFoundWhereTrianglesMeetInTheirVertexAlone) {
    std::mt19937 random(2);
    int clear = 0, crossed = 0;
    for (int n = 0; n < 8000; ++n) {
        const IntegerSoup soup = randomSoup(random, 6, 2, 50);
        auto s = soup.triangles[0], t = soup.triangles[1];
        if (orderByShared(s, t) != 1) continue;
        const std::optional<bool> cross = soup.cross(0, 1);
        if (!cross) continue;
        ASSERT_EQ(touchAtVertexOnly(cornersOf(soup, s), cornersOf(soup, t), 1e-9), !*cross) << n;
        (*cross ? crossed : clear)++;
    }
    EXPECT_GT(clear, 1000);
    EXPECT_GT(crossed, 100);
}

TEST(Certificate, KnowsAFoldByItsAngle) {
    const Corners first{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0.3, 2, 0}};
    for (const double degrees : {0.0, 1.0, 5.0, 90.0, 179.0}) {
        const double angle = degrees * M_PI / 180;
        const Corners second{first[1], first[0],
                             Vec3{0.6, 3 * std::cos(angle), 3 * std::sin(angle)}};
        for (const double least : {0.5, 3.0}) {
            const double sine = std::sin(least * M_PI / 180);
            EXPECT_EQ(touchAtEdgeOnly(first, second, sine * sine), degrees > least)
                << degrees << ' ' << least;
        }
    }
}

TEST(Certificate, IsNotFoundForATriangleWithoutArea) {
    const Corners first{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}},
        line{Vec3{1, 0, 0}, Vec3{0, 0, 0}, Vec3{2, 0, 0}},
        noEdge{Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{2, 0, 0}};
    EXPECT_FALSE(touchAtEdgeOnly(first, line));
    EXPECT_FALSE(touchAtEdgeOnly(noEdge, noEdge));
}

}  // namespace adaptiso::testing
