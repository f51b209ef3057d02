#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso {
namespace {

__extension__ typedef __int128 Int;  // wide enough for every product below

int signOf(Int value) {
    return (value > 0) - (value < 0);
}

struct IntPoint {
    std::int64_t x = 0, y = 0, z = 0;
};

Vec3 toPoint(const IntPoint& p, double unit) {
    return {unit * static_cast<double>(p.x), unit * static_cast<double>(p.y),
            unit * static_cast<double>(p.z)};
}

int trueSide2d(const IntPoint& a, const IntPoint& b, const IntPoint& c) {
    return signOf(Int{b.x - a.x} * (c.y - a.y) - Int{b.y - a.y} * (c.x - a.x));
}

int trueSide3d(const IntPoint& a, const IntPoint& b, const IntPoint& c, const IntPoint& d) {
    const Int ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
    const Int vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    const Int wx = d.x - a.x, wy = d.y - a.y, wz = d.z - a.z;
    return signOf(wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx));
}

/// One of -limit ... limit.
std::int64_t randomInt(std::int64_t limit, std::uint64_t& state) {
    return static_cast<std::int64_t>(testing::nextRandom(state) %
                                     static_cast<std::uint64_t>(2 * limit + 1)) -
           limit;
}

IntPoint randomPoint(std::int64_t limit, std::uint64_t& state) {
    return {randomInt(limit, state), randomInt(limit, state), randomInt(limit, state)};
}

TEST(Orient3d, IsPositiveWhereTheNormalPoints) {
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 7, 0}), 0);
}

TEST(Orient3d, AgreesWithWholeNumbers) {
    // From grids where every third answer is 0 to coordinates of 40 bits: differences of 41 bits,
    // products of 126.
    int zeros = 0;
    for (const std::int64_t limit : {1, 2, 10, 1000, 1 << 20, 1 << 30}) {
        std::uint64_t state = static_cast<std::uint64_t>(limit);
        for (int n = 0; n < 20000; ++n) {
            const IntPoint a = randomPoint(limit << 10, state), b = randomPoint(limit, state),
                           c = randomPoint(limit, state), d = randomPoint(limit, state);
            const int truth = trueSide3d(b, c, d, {b.x, c.y, d.z});
            zeros += truth == 0;
            ASSERT_EQ(
                orient3d(toPoint(b, 1), toPoint(c, 1), toPoint(d, 1), toPoint({b.x, c.y, d.z}, 1)),
                truth);
            ASSERT_EQ(orient3d(toPoint(a, 1), toPoint(b, 1), toPoint(c, 1), toPoint(d, 1)),
                      trueSide3d(a, b, c, d));
        }
    }
    EXPECT_GT(zeros, 10000);
}

TEST(Orient3d, IsExactOneUnitFromAThinPlane) {
    // d in the plane of a, b, c or one unit of 2^-30 beside it, with coordinates of 38 bits:
    // rounded products have errors of thousands of such units.
    constexpr double kUnit = 0x1p-30;
    std::uint64_t state = 5;
    int zeros = 0, filtered = 0;
    for (int n = 0; n < 50000; ++n) {
        const IntPoint a = randomPoint(std::int64_t{1} << 38, state);
        const IntPoint u = randomPoint(1 << 20, state), v = randomPoint(1 << 20, state);
        const std::int64_t s = randomInt(1 << 16, state), t = randomInt(1 << 16, state);
        const IntPoint b{a.x + u.x, a.y + u.y, a.z + u.z}, c{a.x + v.x, a.y + v.y, a.z + v.z};
        IntPoint d{a.x + s * u.x + t * v.x, a.y + s * u.y + t * v.y, a.z + s * u.z + t * v.z};
        d.z += randomInt(1, state);
        const int truth = trueSide3d(a, b, c, d);
        zeros += truth == 0;
        const Vec3 pa = toPoint(a, kUnit), pb = toPoint(b, kUnit), pc = toPoint(c, kUnit),
                   pd = toPoint(d, kUnit);
        const double naive = dot(cross(pb - pa, pc - pa), pd - pa);
        filtered += signOf(naive > 0 ? 1 : naive < 0 ? -1 : 0) != truth;
        ASSERT_EQ(orient3d(pa, pb, pc, pd), truth);
        ASSERT_EQ(orient3d(pb, pa, pc, pd), -truth);
        ASSERT_EQ(orient3d(pc, pa, pb, pd), truth);
    }
    EXPECT_GT(zeros, 10000);
    EXPECT_GT(filtered, 100);  // plain arithmetic is wrong often: the test tests something
}

TEST(Orient3d, IsExactWhereDifferencesDoNotFitADouble) {
    // One axis has coordinates of 53 bits and more, so that differences need 54 bits; which axis
    // takes turns. The products stay within 127 bits.
    std::uint64_t state = 9;
    for (int n = 0; n < 30000; ++n) {
        std::array<IntPoint, 4> p;
        for (IntPoint& q : p) {
            q = randomPoint(1 << 16, state);
            q.x = randomInt((std::int64_t{1} << 53) - 1, state);
            if (n % 3 == 1) std::swap(q.x, q.y);
            if (n % 3 == 2) std::swap(q.x, q.z);
        }
        if (n % 2 == 0) p[3] = {p[2].x + randomInt(1, state), p[2].y, p[2].z};
        if (std::abs(p[3].x) >= std::int64_t{1} << 53) continue;
        ASSERT_EQ(orient3d(toPoint(p[0], 1), toPoint(p[1], 1), toPoint(p[2], 1), toPoint(p[3], 1)),
                  trueSide3d(p[0], p[1], p[2], p[3]));
    }
}

TEST(Orient2d, AgreesWithWholeNumbers) {
    int zeros = 0;
    for (const std::int64_t limit : {std::int64_t{2}, std::int64_t{1000}, std::int64_t{1} << 40,
                                     (std::int64_t{1} << 53) - 1}) {
        std::uint64_t state = static_cast<std::uint64_t>(limit);
        for (int n = 0; n < 20000; ++n) {
            const IntPoint a = randomPoint(limit, state), b = randomPoint(limit, state);
            IntPoint c = randomPoint(limit, state);
            if (n % 2 == 0) c = {(a.x + b.x) / 2 + randomInt(1, state), (a.y + b.y) / 2, 0};
            if (std::abs(c.x) > limit) continue;
            const int truth = trueSide2d(a, b, c);
            zeros += truth == 0;
            const auto to2 = [](const IntPoint& p) {
                return Point2{static_cast<double>(p.x), static_cast<double>(p.y)};
            };
            ASSERT_EQ(orient2d(to2(a), to2(b), to2(c)), truth);
            ASSERT_EQ(orient2d(to2(b), to2(a), to2(c)), -truth);
        }
    }
    EXPECT_GT(zeros, 3000);
}

TEST(Orient2d, IsExactOverShewchuksGrid) {
    // [Shewchuk1997, figure 3 after Kettner]: points 2^-53 apart near the line y = x.
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            const Point2 p{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53};
            const int truth = (j > i) - (j < i);
            ASSERT_EQ(orient2d({12, 12}, {24, 24}, p), truth) << i << ", " << j;
        }
    }
}

}  // namespace
}  // namespace adaptiso
