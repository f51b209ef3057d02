#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "adaptive/mesh/BrickPrint.h"

namespace adaptiso {
namespace {

using detail::BrickPrint;

std::vector<Corners> randomTriangles(std::size_t count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> along(-100, 100);
    const auto point = [&] { return Vec3{along(random), along(random), along(random)}; };
    std::vector<Corners> triangles(count);
    for (Corners& t : triangles) t = {point(), point(), point()};
    return triangles;
}

BrickPrint printOf(const std::vector<Corners>& triangles) {
    BrickPrint print;
    for (const Corners& t : triangles) print.add(t);
    return print;
}

TEST(BrickPrint, IsTheSameInAnyOrder) {
    std::vector<Corners> triangles = randomTriangles(1000);
    const BrickPrint print = printOf(triangles);
    EXPECT_EQ(print.triangles, 1000U);
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(2));
    EXPECT_EQ(printOf(triangles), print);
}

TEST(BrickPrint, OfPartsAddsUp) {
    const std::vector<Corners> triangles = randomTriangles(100);
    BrickPrint sum = printOf({triangles.begin(), triangles.begin() + 30});
    sum += printOf({triangles.begin() + 30, triangles.end()});
    EXPECT_EQ(sum, printOf(triangles));
}

// Every coordinate of every corner, moved by its last digit.
TEST(BrickPrint, TellsTheSmallestChangeOfACoordinate) {
    std::vector<Corners> triangles = randomTriangles(100);
    std::set<std::uint64_t> sums{printOf(triangles).sum};
    for (Corners& t : triangles) {
        for (Vec3& corner : t) {
            for (int a = 0; a < 3; ++a) {
                const double kept = corner[a];
                corner[a] = std::nextafter(kept, 1000);
                EXPECT_TRUE(sums.insert(printOf(triangles).sum).second);
                corner[a] = kept;
            }
        }
    }
}

TEST(BrickPrint, TellsATriangleTurnedRoundAndOneCornerTakenFromAnother) {
    std::vector<Corners> triangles = randomTriangles(2);
    const BrickPrint print = printOf(triangles);
    std::swap(triangles[0][1], triangles[0][2]);
    EXPECT_NE(printOf(triangles), print);
    std::swap(triangles[0][1], triangles[0][2]);
    std::swap(triangles[0][0], triangles[1][0]);
    EXPECT_NE(printOf(triangles), print);
}

}  // namespace
}  // namespace adaptiso
