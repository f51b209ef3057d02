#include <gtest/gtest.h>

#include "Grids.h"
#include "SampleTypes.h"

namespace adaptiso::testing {
namespace {

using detail::discreteGaussian;
using detail::latticeGaussians;

/// Of all the 1-D Gaussians together, in space: the sum of variance (M n) (M n)^T, mm2.
Mat3 covarianceMm2(const ImageGeometry& geometry, double sigmaMm) {
    Mat3 sum = Mat3::diagonal(0, 0, 0);
    for (const auto& [step, variance] : latticeGaussians(geometry, sigmaMm)) {
        const Vec3 mm = geometry.indexToPhysical * Vec3{static_cast<double>(step[0]),
                                                        static_cast<double>(step[1]),
                                                        static_cast<double>(step[2])};
        for (int axis = 0; axis < 3; ++axis) sum.column[axis] += variance * mm[axis] * mm;
    }
    return sum;
}

void expectRound(const ImageGeometry& geometry, double sigmaMm, const std::string& name) {
    const Mat3 covariance = covarianceMm2(geometry, sigmaMm);
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
            const double expected = a == b ? sigmaMm * sigmaMm : 0;
            // parts below 1e-6 of a squared step, here up to 9 mm2, are left out
            EXPECT_NEAR(covariance.column[a][b], expected, 6 * 9e-6) << name;
        }
    }
}

TEST(LatticeGaussians, AreRoundInSpaceOnEveryKindOfGrid) {
    for (const auto& [name, geometry] : kindsOfGrid({8, 8, 8}, {0.4, 1, 3})) {
        expectRound(geometry, 1, name);
        expectRound(geometry, 0.3, name);
    }
}

TEST(LatticeGaussians, AreRoundInSpaceHoweverSkewTheAxes) {
    std::uint64_t random = 7;
    const auto next = [&] { return static_cast<double>(nextRandom(random) >> 11) / 0x1p52 - 1; };
    int tried = 0;
    for (int n = 0; n < 200; ++n) {
        ImageGeometry geometry = centredGeometry({8, 8, 8});
        for (Vec3& step : geometry.indexToPhysical.column) step = {next(), next(), next()};
        if (geometry.voxelVolumeMm3() < 0.05) continue;
        expectRound(geometry, 1.5, "random " + std::to_string(n));
        EXPECT_LE(latticeGaussians(geometry, 1.5).size(), 6U);
        ++tried;
    }
    EXPECT_GT(tried, 50);
}

TEST(LatticeGaussians, AreTheAxesWhereTheseAreAtRightAngles) {
    for (const auto& geometry :
         {obliqueGeometry({8, 8, 8}, {0.5, 1, 2}), mirroredGeometry({8, 8, 8}, {0.5, 1, 2})}) {
        const auto gaussians = latticeGaussians(geometry, 1);
        ASSERT_EQ(gaussians.size(), 3U);
        for (const auto& [step, variance] : gaussians) {
            const int axis = step[0] != 0 ? 0 : step[1] != 0 ? 1 : 2;
            EXPECT_EQ(std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]), 1);
            EXPECT_NEAR(variance, std::pow(2, 2 - 2 * axis), 1e-12);  // (1 mm / spacing)^2
        }
    }
}

TEST(DiscreteGaussian, HasItsVarianceBelowAndAboveAVoxel) {
    for (const double variance : {1e-6, 1e-3, 0.04, 0.5, 1.0, 10.0, 2500.0}) {
        const std::vector<double> weights = discreteGaussian(variance);
        double total = weights[0], second = 0;
        for (std::size_t n = 1; n < weights.size(); ++n) {
            const auto distance = static_cast<double>(n);
            total += 2 * weights[n];
            second += 2 * distance * distance * weights[n];
            EXPECT_LE(weights[n], weights[n - 1]);
        }
        EXPECT_NEAR(total, 1, 1e-12);
        EXPECT_NEAR(second / variance, 1, 1.1e-5);  // what is cut off
    }
}

TEST(DiscreteGaussian, HasTheWeightsOfBesselsFunctions) {
    // e^-1 I_n(1): Abramowitz and Stegun, table 9.8
    const std::vector<double> weights = discreteGaussian(1);
    EXPECT_NEAR(weights[0], 0.4657596077, 1e-5);  // scaled up by what is cut off
    EXPECT_NEAR(weights[1], 0.2079104154, 1e-5);
    EXPECT_NEAR(weights[2], 0.0499387769, 1e-5);
}

}  // namespace
}  // namespace adaptiso::testing
