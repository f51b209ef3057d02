#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/Shape.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Walls.h"
#include "adaptiso/MeshQuality/Winding.h"

namespace adaptiso {
namespace {

using testing::cubeMesh;
using testing::icosphere;
using testing::merged;
using testing::torusMesh;
using testing::translated;

TriangleMesh oneTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {{a, b, c}, {}, {{0, 1, 2}}};
}

TriangleMesh unwelded(const TriangleMesh& mesh) {
    TriangleMesh soup;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<VertexId>(soup.points.size());
        for (const VertexId v : t) soup.points.push_back(mesh.points[v]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

TEST(Duplicates, SoundMeshHasNone) {
    const DuplicateReport report = findDuplicates(icosphere(2));
    EXPECT_EQ(report.vertexCount, 0);
    EXPECT_EQ(report.triangleCount, 0);
}

TEST(Duplicates, SoupRepeatsEveryCornerButTheFirst) {
    const DuplicateReport report = findDuplicates(unwelded(cubeMesh()));
    EXPECT_EQ(report.vertexCount, 36 - 8);
    EXPECT_EQ(report.triangleCount, 0);
    EXPECT_EQ(report.vertices.size(), 5u);  // the first few are named
}

TEST(Duplicates, TriangleIsFoundByPlaceWhicheverWayRound) {
    TriangleMesh mesh = unwelded(merged({cubeMesh(), cubeMesh()}));
    std::swap(mesh.triangles[20][0], mesh.triangles[20][1]);
    const DuplicateReport report = findDuplicates(mesh, {.maxExamples = 100});
    EXPECT_EQ(report.triangleCount, 12);
    EXPECT_EQ(report.triangles,
              (std::vector<std::int64_t>{12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23}));
}

TEST(Duplicates, ZeroHasOneSignAndNanNoPlace) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {-0.0, 0, -0.0}, {kNan, 0, 0}, {kNan, 0, 0}};
    mesh.triangles = {{0, 2, 3}, {1, 3, 2}};
    const DuplicateReport report = findDuplicates(mesh);
    EXPECT_EQ(report.vertices, std::vector<VertexId>{1});
    EXPECT_EQ(report.triangleCount, 0);
    EXPECT_THROW(findDuplicates(testing::withIndexOutOfRange(cubeMesh())), InvalidInput);
}

TEST(Shape, RightTriangleOfThreeFourFive) {
    // inscribed circle of radius 1, so the aspect ratio is 5 / (2 sqrt 3); tan of the smallest
    // angle is 3/4
    const ShapeReport report = measureShape(oneTriangle({0, 0, 7}, {4, 0, 7}, {0, 3, 7}));
    EXPECT_EQ(report.triangles, 1);
    EXPECT_DOUBLE_EQ(report.angleDeg.minimum, std::atan2(3, 4) * 180 / std::acos(-1));
    EXPECT_DOUBLE_EQ(report.aspectRatio.maximum, 5 / (2 * std::sqrt(3)));
    EXPECT_EQ(report.edgeMm.minimum, 3);
    EXPECT_EQ(report.edgeMm.median, 4);
    EXPECT_EQ(report.edgeMm.mean, 4);
    EXPECT_EQ(report.edgeMm.maximum, 5);
}

TEST(Shape, EquilateralIsOneAndFlatInfinite) {
    const double h = std::sqrt(0.75);
    TriangleMesh mesh = oneTriangle({0, 0, 0}, {1, 0, 0}, {0.5, h, 0});
    mesh.points.push_back({2, 0, 0});
    mesh.triangles.push_back({0, 1, 3});
    const ShapeReport report = measureShape(mesh);
    EXPECT_NEAR(report.aspectRatio.minimum, 1, 1e-15);  // a few roundings
    EXPECT_EQ(report.aspectRatio.maximum, std::numeric_limits<double>::infinity());
    EXPECT_EQ(report.aspectRatio.triangleOfMaximum, 1);
    EXPECT_EQ(report.angleDeg.minimum, 0);
    EXPECT_EQ(report.angleDeg.triangleOfMinimum, 1);
    EXPECT_NEAR(report.angleDeg.maximum, 60, 1e-13);
}

TEST(Shape, LeavesOutWhatIsNoTriangle) {
    EXPECT_EQ(measureShape(testing::withRepeatedIndex(cubeMesh())).triangles, 12);
    EXPECT_EQ(measureShape(testing::withNanCoordinate(cubeMesh())).triangles,
              12 - 3);  // the first corner is in three triangles
    EXPECT_EQ(measureShape({}).triangles, 0);
}

TEST(Size, GuessesTheUnit) {
    const SizeLimits head{50, 50, 500};
    const auto judged = [&](double mm) { return judgeSize(cubeMesh({}, {mm, mm, 2 * mm}), head); };
    EXPECT_EQ(judged(100).verdict, SizeVerdict::Plausible);
    EXPECT_EQ(judged(100).guess, std::nullopt);
    EXPECT_EQ(judged(0.1).verdict, SizeVerdict::TooSmall);
    EXPECT_EQ(judged(0.1).guess, LengthUnit::Metres);
    EXPECT_EQ(judged(10).guess, LengthUnit::Centimetres);
    EXPECT_EQ(judged(1e5).verdict, SizeVerdict::TooLarge);
    EXPECT_EQ(judged(1e5).guess, LengthUnit::Micrometres);
    EXPECT_EQ(judged(1e-6).guess, std::nullopt);
    EXPECT_EQ(judged(50).verdict, SizeVerdict::Plausible);    // limits are allowed
    EXPECT_EQ(judged(49.9).verdict, SizeVerdict::TooSmall);   // of any side
    EXPECT_EQ(judged(250.1).verdict, SizeVerdict::TooLarge);  // of the longest
}

TEST(Size, IsThatOfUsedFiniteVertices) {
    EXPECT_EQ(judgeSize(testing::withUnusedVertex(cubeMesh()), {}).extentMm, (Vec3{1, 1, 1}));
    EXPECT_EQ(judgeSize({}, {}).verdict, SizeVerdict::Unknown);
}

TEST(Walls, OfABoxAreItsSides) {
    const WallReport walls = measureWalls(cubeMesh({0, 0, 0}, {3, 4, 5}), 3.5);
    EXPECT_DOUBLE_EQ(walls.leastMm, 3);
    EXPECT_DOUBLE_EQ(walls.areaMm2, 94);
    EXPECT_DOUBLE_EQ(walls.thinAreaMm2, 40);  // the two sides of 4 x 5
    EXPECT_EQ(measureWalls(cubeMesh({0, 0, 0}, {3, 4, 5}), 3).thinAreaMm2, 0);
}

TEST(Walls, OfShellsAreWhatLiesBetween) {
    TriangleMesh cavity = cubeMesh({0.5, 2, 2}, {18, 18, 18});
    for (Triangle& t : cavity.triangles) std::swap(t[0], t[1]);
    const WallReport box = measureWalls(merged({cubeMesh({0, 0, 0}, {20, 20, 20}), cavity}), 1);
    EXPECT_DOUBLE_EQ(box.leastMm, 0.5);
    EXPECT_TRUE(box.pointMm.x == 0 || box.pointMm.x == 0.5) << box.pointMm.x;
    EXPECT_GT(box.thinAreaMm2, 16 * 16);  // the cavity's side at least
    EXPECT_LT(box.thinAreaMm2, 16 * 16 + 20 * 20);

    cavity = icosphere(4, {}, 8.5);
    for (Triangle& t : cavity.triangles) std::swap(t[0], t[1]);
    const WallReport ball = measureWalls(merged({icosphere(4, {}, 10), cavity}), 1.6);
    EXPECT_NEAR(ball.leastMm, 1.5, 0.02);  // chords of 4.6 degrees lie 0.01 mm within the sphere
    EXPECT_DOUBLE_EQ(ball.thinShare(), 1);
    EXPECT_NEAR(measureWalls(icosphere(4, {}, 10), 1).leastMm, 20, 0.04);
}

TEST(Walls, AreFoundFromTheirSmallerSide) {
    // 0.3 mm above the ground, below no middle or corner of the ground's two triangles
    TriangleMesh cavity = cubeMesh({60, 55, 0.3}, {61, 56, 1.3});
    for (Triangle& t : cavity.triangles) std::swap(t[0], t[1]);
    const WallReport walls =
        measureWalls(merged({cubeMesh({0, 0, 0}, {100, 100, 10}), cavity}), 0.8);
    EXPECT_NEAR(walls.leastMm, 0.3, 1e-12);
    EXPECT_GT(walls.pointMm.x, 59);
}

TEST(Walls, AreNotFormedByEdges) {
    const TriangleMesh tetrahedron{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                   {},
                                   {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
    ASSERT_GT(enclosedVolume(tetrahedron), 0);
    EXPECT_FALSE(measureWalls(tetrahedron, 1).hasWall());  // sides lean by 70.5 degrees
    EXPECT_FALSE(measureWalls({}, 1).hasWall());
}

TEST(Walls, AreTheSameForAnyNumberOfThreads) {
    const TriangleMesh torus = torusMesh(300, 100, 20, 4);
    const WallReport many = measureWalls(torus, 7.9999);
    const ThreadLimitGuard one(1);
    const WallReport alone = measureWalls(torus, 7.9999);
    EXPECT_EQ(many.leastMm, alone.leastMm);
    EXPECT_EQ(many.triangle, alone.triangle);
    EXPECT_EQ(many.thinAreaMm2, alone.thinAreaMm2);
    EXPECT_NEAR(many.leastMm, 8, 0.02);
}

TEST(SolidAngle, IsTheWholeSphereFromInsideAndNothingFromOutside) {
    const TriangleMesh cube = cubeMesh();
    // twelve arctangents, each rounded to 1e-16 of 4 pi
    EXPECT_NEAR(solidAngleShare(cube, {0.5, 0.5, 0.5}), 1, 1e-14);
    EXPECT_NEAR(solidAngleShare(cube, {0.1, 0.7, 0.9}), 1, 1e-14);
    EXPECT_NEAR(solidAngleShare(cube, {1.5, 0.5, 0.5}), 0, 1e-14);
    TriangleMesh insideOut = cube;
    flipOrientation(insideOut);
    EXPECT_NEAR(solidAngleShare(insideOut, {0.5, 0.5, 0.5}), -1, 1e-14);
}

TEST(SolidAngle, FaceOfACubeIsASixthFromItsMiddle) {
    const TriangleMesh face{
        {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, {}, {{0, 1, 2}, {0, 2, 3}}};
    EXPECT_NEAR(solidAngleShare(face, {}), 1.0 / 6, 1e-15);
}

TEST(SolidAngle, CriterionFailsOpenAndFlippedSurfaces) {
    EXPECT_TRUE(solidAngleFromMean(icosphere(3)).isMet());
    EXPECT_FALSE(solidAngleFromMean(testing::withHole(icosphere(3))).isMet());
    EXPECT_FALSE(solidAngleFromMean(testing::withFlippedTriangle(icosphere(3))).isMet());
    EXPECT_FALSE(solidAngleFromMean(testing::withNanCoordinate(icosphere(3))).isMet());
    EXPECT_FALSE(solidAngleFromMean({}).isMet());
}

TEST(Winding, CavitiesAreTheOtherWayRound) {
    const auto insideOut = [](const TriangleMesh& mesh) {
        return findInsideOutPieces(mesh, checkTopology(mesh)).value();
    };
    TriangleMesh wall = icosphere(2, {}, 5);
    flipOrientation(wall);
    const TriangleMesh ball = icosphere(2, {}, 10), core = icosphere(2, {}, 2),
                       other = icosphere(2, {30, 0, 0}, 5);
    using Pieces = std::vector<std::int64_t>;
    EXPECT_EQ(insideOut(ball), Pieces{});
    EXPECT_EQ(insideOut(wall), Pieces{0});
    EXPECT_EQ(insideOut(merged({ball, wall, core, other})), Pieces{});
    EXPECT_EQ(insideOut(merged({core, wall, ball})), Pieces{});
    EXPECT_EQ(insideOut(merged({ball, core})), Pieces{1});
    EXPECT_EQ(insideOut(merged({wall, other})), Pieces{0});
    EXPECT_THROW(insideOut(testing::withHole(ball)), InvalidInput);
}

TEST(Winding, ACavityMayTouchTheSurfaceAtAVertex) {
    const TriangleMesh cube = cubeMesh({0, 0, 0}, {8, 8, 8});
    TriangleMesh wall = icosphere(2, {3, 3, 3}, 2);
    flipOrientation(wall);
    const auto nearest = std::min_element(
        wall.points.begin(), wall.points.end(),
        [](const Vec3& a, const Vec3& b) { return squaredNorm(a) < squaredNorm(b); });
    ASSERT_NE(nearest, wall.points.begin());
    *nearest = {0, 0, 0};  // a corner of the cube
    wall.normals.clear();
    const TriangleMesh both = merged({cube, wall});
    EXPECT_TRUE(findInsideOutPieces(both, checkTopology(both))->empty());
}

TEST(Winding, PiecesThatCrossLieInNoneOfEachOther) {
    const auto insideOut = [](const TriangleMesh& mesh) {
        return findInsideOutPieces(mesh, checkTopology(mesh)).value();
    };
    const TriangleMesh ball = icosphere(2, {}, 10);
    TriangleMesh shell = icosphere(3, {}, 40), turned = ball;
    flipOrientation(turned);
    using Pieces = std::vector<std::int64_t>;
    for (const Vec3& aside : {Vec3{11, 0, 0}, Vec3{-11, 3, 2}, Vec3{1, 0.5, 0.25}}) {
        const TriangleMesh other = translated(ball, aside), wrong = translated(turned, aside);
        EXPECT_EQ(insideOut(merged({ball, other})), Pieces{});
        EXPECT_EQ(insideOut(merged({other, ball})), Pieces{});
        EXPECT_EQ(insideOut(merged({ball, wrong})), Pieces{1});
        EXPECT_EQ(insideOut(merged({turned, wrong})), (Pieces{0, 1}));
        // walls of one cavity that cross
        EXPECT_EQ(insideOut(merged({shell, turned, wrong})), Pieces{});
        EXPECT_EQ(insideOut(merged({shell, ball, wrong})), Pieces{1});
    }
}

}  // namespace
}  // namespace adaptiso
