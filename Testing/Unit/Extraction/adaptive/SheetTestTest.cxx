#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "Surfaces.h"
#include "adaptive/bricks/SheetTest.h"

namespace adaptiso::testing {
namespace {

using detail::isSingleSheet;
using Step = std::array<int, 3>;

template <class F>
std::uint64_t window(const F& isInside) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
        if (isInside(i % 4, i / 4 % 4, i / 16)) bits |= std::uint64_t{1} << i;
    }
    return bits;
}

std::vector<Step> allSteps() {
    std::vector<Step> steps;
    for (int i = 0; i < 27; ++i) {
        if (i != 13) steps.push_back({i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
    }
    return steps;
}

double degreesBetween(const Step& a, const Step& b) {
    const Vec3 u = normalized({1.0 * a[0], 1.0 * a[1], 1.0 * a[2]}),
               v = normalized({1.0 * b[0], 1.0 * b[1], 1.0 * b[2]});
    return std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / M_PI;
}

/// Over all pairs of samples one step apart: how many go out of the inside, and how many into it.
std::array<int, 2> changesAlong(std::uint64_t bits, const Step& step) {
    std::array<int, 2> changes{};
    for (int i = 0; i < 64; ++i) {
        const int x = i % 4 + step[0], y = i / 4 % 4 + step[1], z = i / 16 + step[2];
        if (x < 0 || x > 3 || y < 0 || y > 3 || z < 0 || z > 3) continue;
        const bool here = (bits >> i & 1) != 0, there = (bits >> (x + 4 * (y + 4 * z)) & 1) != 0;
        if (here != there) ++changes[here ? 0 : 1];
    }
    return changes;
}

/// The definition, word for word.
bool isSingleByDefinition(std::uint64_t bits) {
    for (const Step& direction : allSteps()) {
        bool onlyLeaves = changesAlong(bits, direction)[0] > 0;
        for (const Step& other : allSteps()) {
            if (degreesBetween(direction, other) <= 50 && changesAlong(bits, other)[1] > 0) {
                onlyLeaves = false;
            }
        }
        if (onlyLeaves) return true;
    }
    return false;
}

}  // namespace

TEST(SheetTest, KnowsOneSheetFromTwo) {
    EXPECT_TRUE(isSingleSheet(window([](int, int, int z) { return z < 2; })));
    EXPECT_TRUE(isSingleSheet(window([](int x, int, int z) { return x + z < 3; })));
    EXPECT_TRUE(isSingleSheet(window([](int x, int y, int z) { return x < 2 && y < 2 && z < 2; })));
    EXPECT_FALSE(isSingleSheet(window([](int, int, int z) { return z == 1; })));
    EXPECT_FALSE(isSingleSheet(window([](int, int, int z) { return z != 1; })));
    EXPECT_FALSE(isSingleSheet(window([](int x, int, int z) { return z == 1 && x < 2; })));
    EXPECT_FALSE(isSingleSheet(window([](int x, int y, int) { return x == y; })));
    EXPECT_FALSE(isSingleSheet(0));
    EXPECT_FALSE(isSingleSheet(~std::uint64_t{0}));
}

// The lattice direction nearest to a plane's normal is less than 30 degrees off, so all within 50
// degrees of it leave the inside, too.
TEST(SheetTest, KnowsEveryPlane) {
    std::mt19937 random(3);
    int planes = 0;
    for (int n = 0; n < 2000; ++n) {
        const Vec3 normal = normalized(randomPoint(random)), point = randomPoint(random, 2);
        const std::uint64_t bits = window([&](int x, int y, int z) {
            return dot(normal, Vec3{x - 1.5, y - 1.5, z - 1.5} - point) < 0;
        });
        if (bits == 0 || bits == ~std::uint64_t{0}) continue;
        ++planes;
        ASSERT_TRUE(isSingleSheet(bits)) << n;
        ASSERT_TRUE(isSingleSheet(~bits)) << n;
    }
    EXPECT_GT(planes, 1000);
}

TEST(SheetTest, FindsNoSheetInNoise) {
    std::mt19937_64 random(4);
    for (int n = 0; n < 10000; ++n) ASSERT_FALSE(isSingleSheet(random()));
}

// Planes, with single samples turned over.
TEST(SheetTest, SaysWhatItsDefinitionSays) {
    std::mt19937 random(5);
    int single = 0;
    for (int n = 0; n < 600; ++n) {
        const Vec3 normal = randomPoint(random), point = randomPoint(random, 2);
        const double bend = randomPoint(random).x;
        std::uint64_t bits = window([&](int x, int y, int z) {
            const Vec3 p = Vec3{x - 1.5, y - 1.5, z - 1.5} - point;
            return dot(normal, p) + bend * squaredNorm(p) < 0;
        });
        for (int flips = n % 3; flips > 0; --flips) bits ^= std::uint64_t{1} << random() % 64;
        ASSERT_EQ(isSingleSheet(bits), isSingleByDefinition(bits)) << n;
        single += isSingleSheet(bits) ? 1 : 0;
    }
    EXPECT_GT(single, 100);
    EXPECT_LT(single, 500);
}

}  // namespace adaptiso::testing
