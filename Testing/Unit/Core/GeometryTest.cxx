#include <gtest/gtest.h>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso {
namespace {

void expectNear(const Vec3& a, const Vec3& b, double tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

constexpr double kRounding = 1e-12;  // a dozen operations on numbers up to 100: 1e-14 each

TEST(Vec3, CrossFollowsTheRightHand) {
    EXPECT_EQ(cross({1, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
    EXPECT_EQ(cross({0, 1, 0}, {0, 0, 1}), (Vec3{1, 0, 0}));
    EXPECT_EQ(areaVector2({1, 1, 1}, {3, 1, 1}, {1, 4, 1}), (Vec3{0, 0, 6}));
}

TEST(Vec3, IndexesItsCoordinates) {
    Vec3 v{1, 2, 3};
    v[1] = 5;
    EXPECT_EQ(v, (Vec3{1, 5, 3}));
    EXPECT_EQ(v[0] + v[2], 4);
}

TEST(Vec3, NormalizedZeroStaysZero) {
    EXPECT_EQ(normalized({0, 0, 0}), (Vec3{0, 0, 0}));
    EXPECT_EQ(normalized({0, 0, -7}), (Vec3{0, 0, -1}));
    EXPECT_EQ(toNormal({0, 3, 0}), (Normal{0, 1, 0}));
}

TEST(Mat3, ColumnsAreWhereTheAxesGo) {
    const Mat3 m{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}};
    EXPECT_EQ(m * Vec3({0, 1, 0}), (Vec3{4, 5, 6}));
    EXPECT_EQ(determinant(m), -3);
    EXPECT_EQ(transpose(m).column[0], (Vec3{1, 4, 7}));
}

TEST(Mat3, TimesItsInverseIsTheIdentity) {
    const Mat3 m{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}};
    for (const Mat3& product : {m * inverse(m), inverse(m) * m}) {
        expectNear(product.column[0], {1, 0, 0}, kRounding);
        expectNear(product.column[1], {0, 1, 0}, kRounding);
        expectNear(product.column[2], {0, 0, 1}, kRounding);
    }
}

TEST(ImageGeometry, PlacesVoxelsByOriginAndSteps) {
    ImageGeometry geometry;
    geometry.size = {4, 5, 6};
    geometry.originMm = {10, 20, 30};
    geometry.indexToPhysical = Mat3::diagonal(0.5, -1, 2);
    EXPECT_EQ(geometry.voxelCount(), 120);
    EXPECT_EQ(geometry.toPhysical({2, 3, 1}), (Vec3{11, 17, 32}));
    EXPECT_EQ(geometry.spacingMm(), (Vec3{0.5, 1, 2}));
    EXPECT_DOUBLE_EQ(geometry.voxelVolumeMm3(), 1);
    EXPECT_TRUE(geometry.isMirrored());
}

TEST(ImageGeometry, ToIndexUndoesToPhysical) {
    const Index3 size{40, 50, 60};
    const Vec3 spacing{0.4, 0.9, 2.5};
    for (const ImageGeometry& geometry :
         {testing::centredGeometry(size, spacing), testing::obliqueGeometry(size, spacing),
          testing::shearedGeometry(size, spacing), testing::mirroredGeometry(size, spacing)}) {
        const Vec3 index{3.25, 41, -7.5};
        expectNear(geometry.toIndex(geometry.toPhysical(index)), index, kRounding);
        expectNear(geometry.toPhysical({19.5, 24.5, 29.5}), {0, 0, 0}, kRounding);
    }
}

TEST(ImageGeometry, GradientIsPerMillimetreOnSlantedAndUnevenVoxels) {
    // f(x) = g . x has the gradient g in space and (g . step of i, j, k) per index.
    const Vec3 g{3, -2, 5};
    for (const ImageGeometry& geometry : {testing::obliqueGeometry({4, 4, 4}, {0.4, 0.9, 2.5}),
                                          testing::shearedGeometry({4, 4, 4}, {0.4, 0.9, 2.5}),
                                          testing::mirroredGeometry({4, 4, 4}, {0.4, 0.9, 2.5})}) {
        const auto& step = geometry.indexToPhysical.column;
        const Vec3 perIndex{dot(g, step[0]), dot(g, step[1]), dot(g, step[2])};
        expectNear(geometry.gradientToPhysical() * perIndex, g, kRounding);
    }
}

}  // namespace
}  // namespace adaptiso
