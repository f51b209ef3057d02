#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "adaptiso/Core/PolygonTriangulation.h"

namespace adaptiso {
namespace {

using Ring = std::vector<Point2>;
using Indices = std::array<std::uint32_t, 3>;

double signedArea(const Point2& a, const Point2& b, const Point2& c) {
    return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

double signedArea(const Ring& ring) {
    double area = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        area += signedArea({0, 0}, ring[i], ring[(i + 1) % ring.size()]);
    }
    return area;
}

/// n - 2 counter-clockwise triangles whose areas add up to the ring's.
void expectCovers(const Ring& ring) {
    const std::vector<Indices> triangles = triangulatePolygon(ring);
    ASSERT_EQ(triangles.size(), ring.size() - 2);
    double area = 0;
    for (const auto& [a, b, c] : triangles) {
        EXPECT_EQ(orient2d(ring[a], ring[b], ring[c]), 1) << a << " " << b << " " << c;
        area += signedArea(ring[a], ring[b], ring[c]);
    }
    EXPECT_NEAR(area, signedArea(ring), 1e-12 * area);  // sums of at most a few thousand terms
}

/// Its corners in every order that begins elsewhere.
void expectCoversFromEveryCorner(Ring ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        std::rotate(ring.begin(), ring.begin() + 1, ring.end());
        expectCovers(ring);
    }
}

Ring reversed(Ring ring) {
    std::reverse(ring.begin(), ring.end());
    return ring;
}

const Ring kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const Ring kAngle{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};  // an L

TEST(PolygonTriangulation, CutsConvexAndConcavePolygons) {
    EXPECT_EQ(triangulatePolygon(Ring{{0, 0}, {1, 0}, {0, 1}}), (std::vector<Indices>{{2, 0, 1}}));
    expectCoversFromEveryCorner(kSquare);
    expectCoversFromEveryCorner(kAngle);
    const Ring arrow{{0, 0}, {2, 1}, {0, 2}, {1, 1}};
    expectCoversFromEveryCorner(arrow);
}

TEST(PolygonTriangulation, CutsCombsAndSpirals) {
    Ring comb{{0, 0}, {20, 0}};
    for (double x = 20; x > 0; x -= 2) {
        comb.push_back({x, 5});
        comb.push_back({x - 1, 1});
    }
    comb.push_back({0, 5});
    expectCoversFromEveryCorner(comb);

    Ring outer, inner;
    for (int i = 0; i <= 200; ++i) {
        const double angle = 0.1 * i;
        outer.push_back({(2 + angle) * std::cos(angle), (2 + angle) * std::sin(angle)});
        inner.push_back({(1 + angle) * std::cos(angle), (1 + angle) * std::sin(angle)});
    }
    Ring spiral = outer;
    spiral.insert(spiral.end(), inner.rbegin(), inner.rend());
    expectCovers(spiral);
}

TEST(PolygonTriangulation, PrefersWellShapedTriangles) {
    // The short diagonal of a kite halves it into better triangles.
    const Ring kite{{0, 0}, {4, -1}, {8, 0}, {4, 1}};
    const std::vector<Indices> triangles = triangulatePolygon(kite);
    for (const Indices& triangle : triangles) {
        EXPECT_TRUE(std::ranges::find(triangle, 1U) != triangle.end());
        EXPECT_TRUE(std::ranges::find(triangle, 3U) != triangle.end());
    }
    EXPECT_EQ(triangles.size(), 2);
}

TEST(PolygonTriangulation, GivesCollinearCornersTrianglesWithAnArea) {
    Ring square;  // ten corners on each side
    for (int i = 0; i < 10; ++i) square.push_back({i / 10., 0});
    for (int i = 0; i < 10; ++i) square.push_back({1, i / 10.});
    for (int i = 0; i < 10; ++i) square.push_back({1 - i / 10., 1});
    for (int i = 0; i < 10; ++i) square.push_back({0, 1 - i / 10.});
    expectCoversFromEveryCorner(square);
    const Ring fan{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {2, 3}};  // one corner off a line
    expectCoversFromEveryCorner(fan);
}

TEST(PolygonTriangulation, CutsPolygonsWithBridgesToHoles) {
    // A square of 4 with a hole of 1 in it; another two, one bridged to the other.
    const Ring one{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}};
    EXPECT_DOUBLE_EQ(signedArea(one), 15);
    expectCoversFromEveryCorner(one);
    const Ring two{{0, 0}, {4, 0}, {4, 4},   {0, 4},   {0, 0}, {1, 1}, {1, 2},
                   {2, 2}, {3, 3}, {3, 2.5}, {2.5, 2}, {2, 2}, {2, 1}, {1, 1}};
    expectCoversFromEveryCorner(two);
    // A hole that touches the outline: a bridge without length.
    const Ring touching{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 2}, {2, 1}};
    EXPECT_DOUBLE_EQ(signedArea(touching), 14.5);
    expectCoversFromEveryCorner(touching);
    // A cut into the inside: out and back.
    const Ring slit{{0, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 2}, {2, 4}, {0, 4}};
    expectCoversFromEveryCorner(slit);
}

TEST(PolygonTriangulation, GivesNothingForRingsThatCrossThemselves) {
    const Ring bowTie{{0, 0}, {2, 2}, {2, 0}, {0, 2}};
    EXPECT_TRUE(triangulatePolygon(bowTie).empty());
    EXPECT_TRUE(triangulatePolygon(reversed(bowTie)).empty());
    Ring twice = kSquare;
    twice.insert(twice.end(), kSquare.begin(), kSquare.end());
    EXPECT_TRUE(triangulatePolygon(twice).empty());
    Ring pentagram;
    for (int i = 0; i < 5; ++i) {
        const double angle = 4 * std::numbers::pi * i / 5;
        pentagram.push_back({std::cos(angle), std::sin(angle)});
    }
    EXPECT_TRUE(triangulatePolygon(pentagram).empty());
    // A bar through a square, whose corners all lie outside.
    const Ring cross{{0, 0}, {4, 0}, {4, 4}, {-1, 4}, {-1, 2}, {5, 2}, {5, 3}, {0, 3}};
    EXPECT_TRUE(triangulatePolygon(cross).empty());
    // Two triangles on the same side of a bridge.
    const Ring overlap{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 2}, {2, 1}, {2, 2}, {1, 2}};
    EXPECT_TRUE(triangulatePolygon(overlap).empty());
}

TEST(PolygonTriangulation, GivesNothingForRingsWithoutAnInside) {
    EXPECT_TRUE(triangulatePolygon({}).empty());
    EXPECT_TRUE(triangulatePolygon(Ring{{0, 0}, {1, 0}}).empty());
    EXPECT_TRUE(triangulatePolygon(reversed(kSquare)).empty());
    EXPECT_TRUE(triangulatePolygon(reversed(kAngle)).empty());
    const Ring spike{{0, 0}, {1, 0}, {3, 0}, {1, 0}, {1, 1}, {0, 1}};
    EXPECT_TRUE(triangulatePolygon(spike).empty());
    const Ring cornerToCorner{{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};
    EXPECT_TRUE(triangulatePolygon(cornerToCorner).empty());
}

int degenerateCount(const Ring& ring) {
    int count = 0;
    for (const auto& [a, b, c] : triangulatePolygon(ring)) {
        count += orient2d(ring[a], ring[b], ring[c]) == 0;
    }
    return count;
}

TEST(PolygonTriangulation, HasTrianglesWithoutAreaOnlyWhereCornersCoincideOrAllLieOnALine) {
    const Ring repeated{{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    EXPECT_EQ(triangulatePolygon(repeated).size(), 4);
    EXPECT_EQ(degenerateCount(repeated), 2);
    const Ring line{{0, 0}, {1, 1}, {3, 3}, {2, 2}};
    EXPECT_EQ(triangulatePolygon(line).size(), 2);
    EXPECT_EQ(degenerateCount(line), 2);
    EXPECT_EQ(triangulatePolygon(Ring(5, {1, 2})).size(), 3);
}

TEST(PolygonTriangulation, CoversStarShapedPolygons) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> radius(0.1, 1);
    for (int n = 0; n < 300; ++n) {
        Ring star;
        const int count = 5 + n;
        for (int i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * i / count, r = radius(random);
            star.push_back({r * std::cos(angle), r * std::sin(angle)});
        }
        expectCovers(star);
    }
}

TEST(PolygonTriangulation, CoversStarShapedPolygonsOfWholeNumbers) {
    // Coordinates from a few whole numbers: many corners lie on lines, and some edges touch.
    std::mt19937 random(2);
    std::uniform_int_distribution<int> radius(1, 3);
    constexpr std::array<Point2, 8> kDirections{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    for (int n = 0; n < 1000; ++n) {
        Ring star;
        for (const Point2& direction : kDirections) {
            const double r = radius(random);
            star.push_back({r * direction[0], r * direction[1]});
        }
        expectCovers(star);
    }
}

}  // namespace
}  // namespace adaptiso
