#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::testing {
namespace {

/// A fan around point 0 in the plane; heights by chance.
TriangleMesh fanOf(int corners, double height, std::mt19937& random) {
    std::uniform_real_distribution<double> any(-height, height);
    TriangleMesh mesh;
    mesh.points.push_back({0, 0, any(random)});
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * M_PI * i / corners;
        mesh.points.push_back({std::cos(angle), std::sin(angle), any(random)});
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % corners});
    }
    return mesh;
}

ClearFans fansOf(const TriangleMesh& mesh) {
    return {mesh.points, mesh.triangles};
}

}  // namespace

TEST(ClearFans, KnowsAllVerticesOfRoundMeshes) {
    for (const TriangleMesh& mesh : {icosphere(3), torusMesh(20, 12, 3, 1)}) {
        const ClearFans fans = fansOf(mesh);
        for (std::size_t v = 0; v < mesh.points.size(); ++v) EXPECT_TRUE(fans.isClear(v));
    }
}

TEST(ClearFans, TakesFansThatGoRoundOnceOnly) {
    std::mt19937 random(1);
    EXPECT_TRUE(fansOf(fanOf(3, 0, random)).isClear(0));
    EXPECT_TRUE(fansOf(fanOf(24, 0.1, random)).isClear(0));
    EXPECT_FALSE(fansOf(fanOf(25, 0, random)).isClear(0)) << "more than are looked at";
    TriangleMesh open = fanOf(6, 0, random);
    open.triangles.pop_back();
    EXPECT_FALSE(fansOf(open).isClear(0));
    EXPECT_FALSE(fansOf(fanOf(6, 0, random)).isClear(1)) << "at the border";
    TriangleMesh twice = fanOf(10, 0, random);  // each corner as far round as the next but one
    for (int i = 0; i < 10; ++i) {
        const double angle = 4 * M_PI * i / 10;
        twice.points[1 + i] = {std::cos(angle), std::sin(angle), 0.01 * i};
    }
    EXPECT_FALSE(fansOf(twice).isClear(0));
    TriangleMesh folded = fanOf(6, 0, random);
    folded.points[1] = {-0.5, 0.1, 0};  // beyond the vertex: two triangles face the other way
    EXPECT_FALSE(fansOf(folded).isClear(0));
    TriangleMesh notFinite = fanOf(6, 0, random);
    notFinite.points[2].x = std::nan("");
    EXPECT_FALSE(fansOf(notFinite).isClear(0));
}

TEST(ClearFans, NoTwoTrianglesOfAClearFanCross) {
    std::mt19937 random(2);
    std::normal_distribution<double> any;
    int clear = 0, crossed = 0;
    for (int n = 0; n < 20000; ++n) {
        TriangleMesh mesh = fanOf(3 + n % 6, 0, random);
        for (Vec3& p : mesh.points) p = p + 0.4 * Vec3{any(random), any(random), any(random)};
        bool crosses = false;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const auto cornersOf = [&](std::size_t t) {
                    const auto& [a, b, c] = mesh.triangles[t];
                    return std::array{mesh.points[a], mesh.points[b], mesh.points[c]};
                };
                crosses = crosses || trianglesCross(cornersOf(i), cornersOf(j));
            }
        }
        const ClearFans fans = fansOf(mesh);
        clear += fans.isClear(0) ? 1 : 0;
        crossed += crosses ? 1 : 0;
        EXPECT_FALSE(fans.isClear(0) && crosses) << n;
        EXPECT_EQ(fans.areClear(mesh.triangles[0], mesh.triangles[1]), fans.isClear(0));
    }
    EXPECT_GT(clear, 5000);
    EXPECT_GT(crossed, 1000);
}

TEST(ClearFans, TrianglesThatShareNoVertexAreNotClear) {
    const TriangleMesh mesh = icosphere(1);
    const ClearFans fans = fansOf(mesh);
    EXPECT_FALSE(fans.areClear(Triangle{0, 1, 2}, Triangle{3, 4, 5}));
}

}  // namespace adaptiso::testing
