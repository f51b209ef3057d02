#include <gtest/gtest.h>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/PortableMath.h"

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

TEST(PortableMath, GivesTheNearestDouble) {
    // by 60 decimal digits; glibc 2.36 misses each of these but the last of a row
    using portable::cubeRoot;
    EXPECT_EQ(cubeRoot(2), 0x1.428a2f98d728bp+0);
    EXPECT_EQ(cubeRoot(0.7), 0x1.c69b5a72f1a99p-1);
    EXPECT_EQ(cubeRoot(0.263671875), 0x1.4850bcdbf139fp-1);
    EXPECT_EQ(cubeRoot(3.375), 1.5);
    EXPECT_EQ(cubeRoot(-1e-9), -0.001);
    EXPECT_EQ(cubeRoot(27), 3);
    EXPECT_EQ(cubeRoot(0), 0);
    EXPECT_EQ(portable::sin(5.5988), -0x1.43af4e9f7d8d9p-1);
    EXPECT_EQ(portable::sin(-0.259), -0x1.0642c1d85096fp-2);
    EXPECT_EQ(portable::sin(0.5), 0x1.eaee8744b05f0p-2);
    EXPECT_EQ(portable::cos(-5.2162), 0x1.ee5a59a0ba2e1p-2);
    EXPECT_EQ(portable::cos(2.1059), -0x1.051593024d97dp-1);
    EXPECT_EQ(portable::cos(1.0), 0x1.14a280fb5068cp-1);
    EXPECT_EQ(portable::exp(-16.4913), 0x1.27b8124c8b977p-24);
    EXPECT_EQ(portable::exp(-8.5552), 0x1.93c9cfa4e247ap-13);
    EXPECT_EQ(portable::exp(-2.5), 0x1.50385c094f425p-4);
    EXPECT_EQ(portable::log(62.7141), 0x1.08de99157c3cap+2);
    EXPECT_EQ(portable::log(1.7424), 0x1.1c4b7e7415cecp-1);
    EXPECT_EQ(portable::log(10.0), 0x1.26bb1bbb55516p+1);
    EXPECT_EQ(portable::exp(-800), 0);
    EXPECT_EQ(portable::power(0.1, 3), 0x1.0624dd2f1a9fdp-10);
    std::uint64_t state = 1;
    for (int n = 0; n < 1000; ++n) {
        const double x = static_cast<double>(testing::nextRandom(state) >> 11) * 0x1p-40;
        EXPECT_EQ(cubeRoot(8 * x), 2 * cubeRoot(x)) << x;
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
