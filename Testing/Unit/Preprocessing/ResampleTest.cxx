#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "Grids.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

constexpr auto kLinear = Interpolation::Linear;

bool isCubic(const ImageGeometry& grid, double stepMm) {
    const auto& axes = grid.indexToPhysical.column;
    bool result = true;
    for (int axis = 0; axis < 3; ++axis) {
        result = result && std::abs(norm(axes[axis]) - stepMm) < 1e-12 &&
                 std::abs(dot(axes[axis], axes[(axis + 1) % 3])) < 1e-12;
    }
    return result;
}

Vec3 middleOf(const ImageGeometry& geometry) {
    return geometry.toPhysical({static_cast<double>(geometry.size[0] - 1) / 2,
                                static_cast<double>(geometry.size[1] - 1) / 2,
                                static_cast<double>(geometry.size[2] - 1) / 2});
}

TEST(IsotropicGrid, HasCubicVoxelsAroundTheSameMiddleAndKeepsHandedness) {
    for (auto [name, geometry] : kindsOfGrid({21, 31, 16}, {0.5, 0.8, 3})) {
        geometry.originMm += {30, -120, 700};
        const ImageGeometry grid = isotropicGrid(geometry, 0.9);
        EXPECT_TRUE(isCubic(grid, 0.9)) << name;
        EXPECT_LT(norm(middleOf(grid) - middleOf(geometry)), 1e-9) << name;
        EXPECT_EQ(grid.isMirrored(), geometry.isMirrored()) << name;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GT(dot(grid.indexToPhysical.column[axis], geometry.indexToPhysical.column[axis]),
                      0)
                << name;
        }
    }
}

TEST(IsotropicGrid, HoldsAsManyStepsAsFitBetweenTheOutermostCentres) {
    // spans of 10, 24 and 45 mm between centres
    const ImageGeometry geometry = obliqueGeometry({21, 31, 16}, {0.5, 0.8, 3});
    EXPECT_EQ(isotropicGrid(geometry, 1).size, (Index3{11, 25, 46}));
    EXPECT_EQ(isotropicGrid(geometry, 0.1).size, (Index3{101, 241, 451}));
    EXPECT_EQ(isotropicGrid(geometry, 7).size, (Index3{2, 4, 7}));
    const Vec3 corner = geometry.toIndex(isotropicGrid(geometry, 7).toPhysical({0, 0, 0}));
    // 3, 3 and 3 mm are left over: half of them at each side
    EXPECT_NEAR(corner.x, 1.5 / 0.5, 1e-9);
    EXPECT_NEAR(corner.y, 1.5 / 0.8, 1e-9);
    EXPECT_NEAR(corner.z, 1.5 / 3, 1e-9);
}

TEST(IsotropicGrid, HoldsAllOfAShearedImage) {
    // j slips by 0.3 * 3 mm a slice: 15 slices widen it from 24 to 37.5 mm
    const ImageGeometry geometry = shearedGeometry({21, 31, 16}, {0.5, 0.8, 3});
    EXPECT_EQ(isotropicGrid(geometry, 0.5).size, (Index3{21, 76, 91}));
}

TEST(IsotropicGrid, RefusesStepsThatAreNoneOrDoNotFit) {
    const ImageGeometry geometry = centredGeometry({11, 11, 3}, {1, 1, 2});
    EXPECT_NO_THROW(isotropicGrid(geometry, 4));
    for (const double step :
         {0.0, -1.0, 4.1, 1e300, 1e-300, 1e-15, std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(isotropicGrid(geometry, step), InvalidInput) << step;
    }
}

TEST(Resample, IsExactForALinearRampOnEveryKindOfGrid) {
    const auto ramp = [](const Vec3& p) { return 5 + 2 * p.x - 3 * p.y + p.z; };
    for (const auto& [name, geometry] : kindsOfGrid({15, 12, 9}, {0.7, 1.1, 2.9})) {
        for (const double step : {0.31, 1.0, 2.5}) {
            const Volume volume = sampledFrom<double>(geometry, ramp);
            const Volume resampled = resampleVolume(volume, step, kLinear);
            const auto view = resampled.view().as<double>();
            const ImageGeometry& image = geometry;  // Clang 14 captures no part of a pair
            SCOPED_TRACE(name);
            int inside = 0;
            forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
                const Vec3 index = image.toIndex(point);
                for (int axis = 0; axis < 3; ++axis) {
                    const auto last = static_cast<double>(image.size[axis] - 1);
                    if (index[axis] < -1e-9 || index[axis] > last + 1e-9) return;
                }
                EXPECT_NEAR(view.samples[n], ramp(point), 1e-9) << step;
                ++inside;
            });
            // all of it, unless the image is sheared
            if (name != "sheared") {
                EXPECT_EQ(inside, view.geometry.voxelCount()) << name;
            }
            EXPECT_GT(inside, 10) << name;
        }
    }
}

TEST(Resample, FillsWhatLiesAroundAShearedImageWithItsSmallestValue) {
    const ImageGeometry geometry = shearedGeometry({10, 20, 20}, {1, 1, 2});
    const Volume volume =
        sampledFrom<float>(geometry, [](const Vec3& p) { return p.x < -4 ? -7 : 50; });
    for (const auto interpolation : {Interpolation::Nearest, kLinear}) {
        const Volume resampled = resampleVolume(volume, 1, interpolation);
        const auto view = resampled.view().as<float>();
        forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
            const Vec3 index = geometry.toIndex(point);
            // the outermost voxels reach half a voxel beyond their centres
            const bool isOutside = index.y < -0.51 || index.y > 19.51;
            const bool isInside = index.y > -0.49 && index.y < 19.49;
            if (isOutside) {
                EXPECT_EQ(view.samples[n], -7);
            }
            if (isInside && index.x > 1) {
                EXPECT_EQ(view.samples[n], 50);
            }
        });
    }
}

template <class T>
class NearestOf : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(NearestOf, PixelTypes);

TYPED_TEST(NearestOf, LabelsKeepTypeAndValuesAndPlace) {
    // labels of 5 mm slabs on 1 x 1 x 2.5 mm voxels
    const auto label = [](const Vec3& p) { return 3 * (static_cast<int>(p.z + 40) / 5); };
    const ImageGeometry geometry = centredGeometry({6, 6, 12}, {1, 1, 2.5});
    const Volume resampled =
        resampleVolume(sampledFrom<TypeParam>(geometry, label), 0.5, Interpolation::Nearest);
    ASSERT_EQ(resampled.view().pixelType(), pixelTypeOf<TypeParam>());
    const auto view = resampled.view().as<TypeParam>();
    forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
        // the label of the nearest slice; halfway between two, either's
        const double k = geometry.toIndex(point).z;
        const auto below = std::round(k - 1e-6), above = std::round(k + 1e-6);
        const auto value = static_cast<int>(view.samples[n]);
        EXPECT_TRUE(value == label(geometry.toPhysical({0, 0, below})) ||
                    value == label(geometry.toPhysical({0, 0, above})))
            << point.z;
    });
}

TEST(Resample, BSplineIsNearerToASmoothFunctionThanLinear) {
    const auto wave = [](const Vec3& p) {
        return std::sin(0.5 * p.x) * std::cos(0.4 * p.y) + std::sin(0.3 * p.z);
    };
    const ImageGeometry geometry = obliqueGeometry({41, 31, 25}, {0.8, 1, 1.5});
    const Volume volume = sampledFrom<double>(geometry, wave);
    const auto worst = [&](Interpolation interpolation) {
        const Volume resampled = resampleVolume(volume, 0.7, interpolation);
        const auto view = resampled.view().as<double>();
        double error = 0;
        forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
            const Vec3 index = geometry.toIndex(point);
            for (int axis = 0; axis < 3; ++axis) {
                // the spline is mirrored at the border; that fades by 0.27 a voxel
                if (index[axis] < 6) return;
                if (index[axis] > static_cast<double>(geometry.size[axis]) - 7) return;
            }
            error = std::max(error, std::abs(view.samples[n] - wave(point)));
        });
        return error;
    };
    // linear: at most h^2 / 8 |f''| along each axis, f'' at most 0.5^2 and 0.41 in all
    EXPECT_LT(worst(kLinear), 1.5 * 1.5 / 8 * (0.25 + 0.16 + 0.09));
    EXPECT_GT(worst(kLinear), 0.02);
    EXPECT_LT(worst(Interpolation::BSpline), 0.004);  // of the order h^4 |f''''| / 384 an axis
}

TEST(Resample, GivesFloatsThatHoldTheSamples) {
    const ImageGeometry geometry = centredGeometry({5, 5, 5});
    const auto typeOf = [&](auto zero, Interpolation interpolation) {
        return resampleVolume(sampledFrom<decltype(zero)>(geometry, [](auto) { return 1; }), 0.5,
                              interpolation)
            .view()
            .pixelType();
    };
    EXPECT_EQ(typeOf(std::int16_t{}, kLinear), PixelType::Float32);
    EXPECT_EQ(typeOf(std::int16_t{}, Interpolation::BSpline), PixelType::Float32);
    EXPECT_EQ(typeOf(std::int32_t{}, kLinear), PixelType::Float64);
    EXPECT_EQ(typeOf(double{}, Interpolation::BSpline), PixelType::Float64);
}

TEST(Resample, DoesNotDependOnTheNumberOfThreads) {
    const Volume noise = [] {
        const Volume cube = randomVolume<float>({30, 25, 20}, 1000, 3);
        return Volume(
            VolumeView(cube.view().as<float>().samples, obliqueGeometry({30, 25, 20}, {1, 2, 0.7})),
            std::make_shared<Volume>(cube));
    }();
    for (const auto interpolation : {Interpolation::Nearest, kLinear, Interpolation::BSpline}) {
        const auto bytes = [&](int threads) {
            const ThreadLimitGuard limit(threads);
            const Volume resampled = resampleVolume(noise, 0.83, interpolation);
            const auto* first = static_cast<const char*>(resampled.view().samples());
            return std::string(first, first + resampled.view().byteCount());
        };
        const std::string one = bytes(1);
        EXPECT_EQ(one, bytes(2)) << toString(interpolation);
        EXPECT_EQ(one, bytes(7)) << toString(interpolation);
    }
}

TEST(Resample, RefusesWhatCantBeBlendedOrHeld) {
    const ImageGeometry geometry = centredGeometry({9, 9, 9});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Volume odd =
        sampledFrom<float>(geometry, [&](const Vec3& p) { return p.x > 0 ? nan : 1; });
    EXPECT_THROW(resampleVolume(odd, 0.5, kLinear), InvalidInput);
    EXPECT_THROW(resampleVolume(odd, 0.5, Interpolation::BSpline), InvalidInput);
    EXPECT_NO_THROW(resampleVolume(odd, 0.5, Interpolation::Nearest));
    const Volume flat = sampledFrom<std::uint8_t>(geometry, [](auto) { return 1; });
    for (const auto interpolation : {Interpolation::Nearest, kLinear}) {
        EXPECT_THROW(resampleVolume(flat, 1e-4, interpolation), InvalidInput);  // 500 TB
    }
}

}  // namespace
}  // namespace adaptiso::testing
