#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "Arrangement.h"
#include "CutTriangle.h"
#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::testing {
namespace {

using detail::CutTriangle;

/// Sound, crossing nothing, and made of the input's triangles and their parts alone.
/// \param part  of the bound, within which that is proved
void expectCut(const Mended& mended, double part = 0.05, const char* file = __builtin_FILE(),
               int line = __builtin_LINE()) {
    expectSound(mended.mesh, {}, file, line);
    EXPECT_EQ(findSelfIntersections(mended.mesh).pairCount, 0) << file << ":" << line;
    EXPECT_EQ(mended.statistics.cells, 0) << file << ":" << line;
    const MendStatistics& s = mended.statistics;
    EXPECT_LE(std::max(s.resultToInputMm, s.inputToResultMm), part * s.maxErrorMm)
        << file << ":" << line;
}

/// About no axis; columns are orthonormal to rounding.
TriangleMesh turned(TriangleMesh mesh) {
    const Vec3 u = normalized(Vec3{2, 3, 6}), v = normalized(cross(u, Vec3{1, 0, 0})),
               w = cross(u, v);
    for (Vec3& p : mesh.points) p = p.x * u + p.y * v + p.z * w;
    return mesh;
}

TriangleMesh inSinglePrecision(TriangleMesh mesh) {
    for (Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
    }
    return mesh;
}

double areaSeenAlongZ(const std::vector<Vec3>& points,
                      const std::vector<std::array<CutTriangle::Id, 3>>& triangles) {
    double area = 0;
    for (const auto& [a, b, c] : triangles) {
        const double part = areaVector2(points[a], points[b], points[c]).z / 2;
        EXPECT_GT(part, 0);
        area += part;
    }
    return area;
}

TEST(CutTriangle, HasEverySegmentAsEdges) {
    // corners, a point of the border, a square within, and a line across two of its sides
    std::vector<Vec3> points{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {4, 0, 0}, {1, 1, 0},
                             {3, 1, 0}, {3, 3, 0}, {1, 3, 0}, {2, 1, 0}, {2, 3, 0}};
    CutTriangle cut(points, {0, 1, 2}, 1e-12);
    ASSERT_TRUE(cut.addOnBorder(3, 0, 1));
    for (const CutTriangle::Id p : {4, 5, 6, 7}) ASSERT_TRUE(cut.add(p));
    const auto crossingOf = [](CutTriangle::Line one, CutTriangle::Line other) {
        // the line 9 from the border to (2, 4) passes two sides
        return std::optional(one == 1 || other == 1 ? CutTriangle::Id{8} : CutTriangle::Id{9});
    };
    ASSERT_TRUE(cut.addSegment(4, 5, 1, crossingOf));
    ASSERT_TRUE(cut.addSegment(5, 6, 2, crossingOf));
    ASSERT_TRUE(cut.addSegment(6, 7, 3, crossingOf));
    ASSERT_TRUE(cut.addSegment(7, 4, 4, crossingOf));
    points.push_back({2, 0.5, 0});
    points.push_back({2, 4, 0});
    ASSERT_TRUE(cut.add(10));
    ASSERT_TRUE(cut.add(11));
    ASSERT_TRUE(cut.addSegment(10, 11, 9, crossingOf));
    const auto triangles = cut.finish();
    EXPECT_DOUBLE_EQ(areaSeenAlongZ(points, triangles), 32);
    EXPECT_EQ(triangles.size(), 18u);  // 12 points, 4 of them on the border: 2 * 12 - 4 - 2
    const auto hasEdge = [&](CutTriangle::Id a, CutTriangle::Id b) {
        return std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
            return std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) == 2;
        });
    };
    for (const auto& [a, b] : std::vector<std::array<CutTriangle::Id, 2>>{
             {4, 8}, {8, 5}, {5, 6}, {6, 9}, {9, 7}, {7, 4}, {10, 8}, {8, 9}, {9, 11}, {3, 0}}) {
        EXPECT_TRUE(hasEdge(a, b)) << a << " " << b;
    }
}

/// A square within a larger one, in one plane and the other way round: the small one is cut alike.
TEST(Arrangement, CutsTrianglesOfAPlaneAlike) {
    for (const bool isTurned : {false, true}) {
        detail::MendInput input;
        input.mesh.points = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0},
                             {1, 1, 0}, {5, 1, 0}, {5, 5, 0}, {1, 5, 0}};
        input.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
        if (isTurned) input.mesh = turned(input.mesh);
        detail::findEdges(input);
        const auto cut =
            detail::arrange(input, {{0, 2}, {0, 3}, {1, 2}, {1, 3}}, isTurned ? 1e-9 : 1e-12);
        ASSERT_TRUE(cut);
        std::vector<std::array<CutTriangle::Id, 3>> large, small;
        for (std::size_t t = 0; t < cut->triangles.size(); ++t) {
            auto corners = cut->triangles[t];
            std::sort(corners.begin(), corners.end());
            (cut->origin[t] < 2 ? large : small).push_back(corners);
        }
        std::sort(large.begin(), large.end());
        EXPECT_GT(small.size(), 1u);
        for (const auto& corners : small) {
            EXPECT_TRUE(std::binary_search(large.begin(), large.end(), corners));
        }
    }
}

TEST(MendByCutting, UnitesBoxesExactly) {
    struct Case {
        TriangleMesh other;
        double volume;
    };
    for (const auto& [other, volume] :
         {Case{cubeMesh({5, 3, 2}, {15, 12, 14}), 1000 + 1080 - 5 * 7 * 8},  // a corner
          Case{cubeMesh({5, 0, 0}, {15, 10, 10}), 1500},                     // faces in one plane
          Case{cubeMesh({5, 2, 0}, {15, 8, 10}), 1000 + 600 - 300},          // two of them
          Case{cubeMesh({2, 2, 10}, {8, 8, 20}), 1360},                      // on top
          Case{cubeMesh({3, 3, -5}, {7, 7, 15}), 1000 + 320 - 160}}) {       // through
        const TriangleMesh both = merged({cubeMesh({0, 0, 0}, {10, 10, 10}), other});
        const Mended straight = mend(both);
        expectCut(straight);
        EXPECT_NEAR(enclosedVolume(straight.mesh), volume, 1e-9);
        EXPECT_LT(straight.mesh.triangles.size(), 80u);
        for (const TriangleMesh& mesh : {turned(both), inSinglePrecision(turned(both))}) {
            const Mended oblique = mend(mesh);
            expectCut(oblique);
            EXPECT_NEAR(enclosedVolume(oblique.mesh), volume, 1e-3);
            EXPECT_LT(oblique.mesh.triangles.size(), 80u);
        }
    }
}

/// Six plates, 30 degrees apart about their axis: after three they lie in each other but for
/// rounding. Their outline is a star of 24 sides, half a square's diagonal and half its side over
/// cos 30 degrees from the axis.
TEST(MendByCutting, UnitesPlatesTurnedAboutAnAxis) {
    constexpr double kHalf = 50, kDegree = std::numbers::pi / 180;
    std::vector<TriangleMesh> plates;
    for (int n = 0; n < 6; ++n) {
        plates.push_back(cubeMesh({-kHalf, -kHalf, -5}, {kHalf, kHalf, 5}));
        const double c = std::cos(30 * n * kDegree), s = std::sin(30 * n * kDegree);
        for (Vec3& p : plates.back().points) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    }
    const Mended mended = mend(merged(plates));
    expectCut(mended, 0.5);
    const double side = std::numbers::sqrt2 * kHalf, other = kHalf / std::cos(30 * kDegree);
    const double star = 24 * 0.5 * side * other * std::sin(15 * kDegree);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 10 * star, 0.1);
    EXPECT_LT(mended.mesh.triangles.size(), 300u);
}

/// Boxes with corners at whole numbers, whose union is counted in unit cubes. Where they touch
/// along an edge alone, the lattice parts or joins them there; where at a corner, it is moved.
TEST(MendByCutting, UnitesRandomBoxes) {
    constexpr int kSide = 8;
    std::mt19937 random(7);
    const auto draw = [&](int below) { return static_cast<int>(random() % below); };
    int cut = 0;
    constexpr int kScenes = 30;
    for (int scene = 0; scene < kScenes; ++scene) {
        std::vector<TriangleMesh> boxes;
        std::vector<std::uint8_t> isFull(kSide * kSide * kSide);
        for (int n = 3 + draw(4); n > 0; --n) {
            std::array<int, 3> low{}, high{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = draw(kSide - 1);
                high[axis] = low[axis] + 1 + draw(kSide - low[axis]);
                high[axis] = std::min(high[axis], kSide);
            }
            boxes.push_back(cubeMesh({1.0 * low[0], 1.0 * low[1], 1.0 * low[2]},
                                     {1.0 * high[0], 1.0 * high[1], 1.0 * high[2]}));
            for (int z = low[2]; z < high[2]; ++z) {
                for (int y = low[1]; y < high[1]; ++y) {
                    for (int x = low[0]; x < high[0]; ++x) {
                        isFull[(z * kSide + y) * kSide + x] = 1;
                    }
                }
            }
        }
        TriangleMesh mesh = merged(boxes);
        if (scene % 3 == 1) mesh = turned(mesh);
        if (scene % 3 == 2) mesh = inSinglePrecision(turned(mesh));
        MendOptions options;
        options.maxErrorMm = 0.2;
        const Mended mended = mend(mesh, options);
        expectSound(mended.mesh);
        EXPECT_EQ(findSelfIntersections(mended.mesh).pairCount, 0);
        const auto volume = std::count(isFull.begin(), isFull.end(), 1);
        EXPECT_NEAR(enclosedVolume(mended.mesh), static_cast<double>(volume),
                    mended.statistics.cells > 0 ? 2 : 0.2)
            << scene;
        if (mended.statistics.cells == 0) ++cut;
    }
    EXPECT_GT(cut, kScenes / 2);
}

/// A surface that crosses itself everywhere, some of its stars too.
TEST(MendByCutting, PartsStarsThatCrossThemselves) {
    std::mt19937 random(3);
    TriangleMesh spiky = icosphere(3, {}, 10);
    spiky.normals.clear();
    for (Vec3& p : spiky.points) {
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] += static_cast<float>(static_cast<double>(random() % 2001) / 1000 - 1);
        }
    }
    MendOptions options;
    options.maxErrorMm = 0.05;
    const Mended mended = mend(spiky, options);
    expectCut(mended);
    EXPECT_GT(mended.statistics.crossingTriangles, 100);
    for (const int threads : {1, 3}) {
        const ThreadLimitGuard limit(threads);
        EXPECT_EQ(mend(spiky, options).mesh, mended.mesh);
    }
}

TEST(MendByCutting, UnitesCopiesALittleApart) {
    TriangleMesh sphere = icosphere(4, {}, 10), copy = icosphere(4, {0.01, 0.02, 0.005}, 10);
    sphere.normals.clear();
    copy.normals.clear();
    const Mended mended = mend(merged({sphere, copy}));
    expectCut(mended);
    const double more = std::numbers::pi * 10 * 10 * norm(Vec3{0.01, 0.02, 0.005});
    EXPECT_NEAR(enclosedVolume(mended.mesh), enclosedVolume(sphere) + more, 0.05);
}

/// A corner in the middle of another triangle's edge: that triangle is split there.
TEST(MendByCutting, SplitsTrianglesAtCornersInTheirEdges) {
    TriangleMesh cube = cubeMesh({0, 0, 0}, {4, 5, 6});
    for (const std::size_t t : {0, 5, 9}) {
        const auto [a, b, c] = cube.triangles[t];
        const VertexId middle = std::ssize(cube.points);
        cube.points.push_back(0.5 * (cube.points[a] + cube.points[b]));
        cube.triangles[t] = {a, middle, c};
        cube.triangles.push_back({middle, b, c});
    }
    for (const TriangleMesh& mesh : {cube, turned(cube), inSinglePrecision(turned(cube))}) {
        const Mended mended = mend(mesh);
        expectCut(mended);
        EXPECT_EQ(mended.mesh.triangles.size(), 18u);
        EXPECT_NEAR(enclosedVolume(mended.mesh), 120, 1e-4);
    }
}

}  // namespace
}  // namespace adaptiso::testing
