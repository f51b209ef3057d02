#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "Grids.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

/// One voxel of 1 in the middle of nothing.
Volume impulse(const ImageGeometry& geometry) {
    const Index3 middle{geometry.size[0] / 2, geometry.size[1] / 2, geometry.size[2] / 2};
    std::vector<float> samples(static_cast<std::size_t>(geometry.voxelCount()));
    samples[static_cast<std::size_t>(
        middle[0] + geometry.size[0] * (middle[1] + geometry.size[1] * middle[2]))] = 1;
    return Volume::fromSamples(std::move(samples), geometry);
}

struct Moments {
    double total = 0;
    Vec3 mean;
    Mat3 covariance = Mat3::diagonal(0, 0, 0);
};

Moments momentsOf(const VolumeView& volume) {
    const auto view = volume.as<float>();
    Moments moments;
    forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
        moments.total += view.samples[n];
        moments.mean += view.samples[n] * point;
    });
    moments.mean = (1 / moments.total) * moments.mean;
    forEachVoxel(view.geometry, [&](std::size_t n, const Vec3& point) {
        const Vec3 from = point - moments.mean;
        for (int axis = 0; axis < 3; ++axis) {
            moments.covariance.column[axis] +=
                (view.samples[n] / moments.total * from[axis]) * from;
        }
    });
    return moments;
}

TEST(Smooth, SpreadsAnImpulseByTheSameMillimetresInEveryDirectionOnEveryGrid) {
    constexpr double kSigmaMm = 1.5;
    const std::vector<std::pair<Index3, Vec3>> kinds = {
        {{33, 33, 33}, {1, 1, 1}}, {{61, 41, 11}, {0.5, 0.8, 4}}, {{21, 51, 41}, {2, 0.6, 0.9}}};
    for (const auto& [size, spacing] : kinds) {
        for (const auto& [name, geometry] : kindsOfGrid(size, spacing)) {
            const Volume volume = impulse(geometry);
            const Moments before = momentsOf(volume),
                          after = momentsOf(smoothVolume(volume, kSigmaMm));
            EXPECT_NEAR(after.total, 1, 1e-5) << name;  // rounding of 30,000 floats
            EXPECT_LT(norm(after.mean - before.mean), 1e-5) << name;
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    // 1e-4 of the variance, as promised, and the rounding
                    EXPECT_NEAR(after.covariance.column[a][b], a == b ? kSigmaMm * kSigmaMm : 0,
                                5e-4)
                        << name << ' ' << a << ' ' << b;
                }
            }
        }
    }
}

TEST(Smooth, HasTheShapeOfAGaussian) {
    // a discrete Gaussian is higher than the continuous one by 1 / 8 t of its height, t the
    // variance in squared steps: by 1 / 162, 1 / 104 and 1 / 72 along the axes, 3 % together (a
    // sheared image's fourth step adds a little). The impulse holds 0.4 * 0.5 * 0.6 mm3
    constexpr double kSigmaMm = 1.8, kPi = 3.14159265358979;
    for (const auto& [name, geometry] : kindsOfGrid({41, 37, 33}, {0.4, 0.5, 0.6})) {
        const Volume smooth = smoothVolume(impulse(geometry), kSigmaMm);
        const auto view = smooth.view().as<float>();
        const double height =
            geometry.voxelVolumeMm3() / std::pow(2 * kPi * kSigmaMm * kSigmaMm, 1.5);
        const Vec3 middle = momentsOf(smooth).mean;
        SCOPED_TRACE(name);
        forEachVoxel(geometry, [&](std::size_t n, const Vec3& point) {
            const double r2 = squaredNorm(point - middle);
            if (r2 > 9 * kSigmaMm * kSigmaMm) return;  // beyond: both almost nothing
            EXPECT_NEAR(view.samples[n], height * std::exp(-r2 / (2 * kSigmaMm * kSigmaMm)),
                        height / 25);
        });
    }
}

TEST(Smooth, RaisesASphereOfLinearDepthByAsMuchAsOnPaper) {
    // f = R - r; a Gaussian adds sigma^2 / 2 times the Laplacian -2 / r, and no higher order: the
    // Laplacian of 1 / r is 0. So the surface f = 0 moves inwards by sigma^2 / R
    constexpr double kRadius = 12, kSigma = 1;
    for (const auto& [name, geometry] : kindsOfGrid({61, 41, 21}, {0.6, 0.9, 2})) {
        const Volume smooth = smoothVolume(
            sampledFrom<float>(geometry, [](const Vec3& p) { return kRadius - norm(p); }), kSigma);
        const auto view = smooth.view().as<float>();
        SCOPED_TRACE(name);
        int checked = 0;
        const ImageGeometry& image = geometry;  // Clang 14 captures no part of a pair
        forEachVoxel(geometry, [&](std::size_t n, const Vec3& point) {
            const double r = norm(point);
            if (r < 8 || r > 13) return;  // a margin of 5 mm to the centre and to the border
            const Vec3 index = image.toIndex(point);
            for (int axis = 0; axis < 3; ++axis) {
                const double left = index[axis],
                             right = static_cast<double>(image.size[axis] - 1) - index[axis];
                if (std::min(left, right) * image.spacingMm()[axis] < 5) return;
            }
            // a discrete Gaussian of steps h has the fourth cumulant sigma^2 h^2, which adds
            // sigma^2 h^2 / 24 times the fourth derivative, 3 / r^3: 0.001 for h = 2, r = 8
            EXPECT_NEAR(view.samples[n], kRadius - r - kSigma * kSigma / r, 2e-3);
            ++checked;
        });
        EXPECT_GT(checked, 1000) << name;
    }
}

TEST(Smooth, LeavesAConstantAndTheInsideOfARampAlone) {
    for (const auto& [name, geometry] : kindsOfGrid({25, 21, 17}, {1, 1.5, 2})) {
        const Volume flat =
            smoothVolume(sampledFrom<std::int16_t>(geometry, [](auto) { return -1024; }), 2);
        ASSERT_EQ(flat.view().pixelType(), PixelType::Float32);
        const auto ramp = [](const Vec3& p) { return 3 + 0.5 * p.x - p.y + 0.25 * p.z; };
        const Volume sloped = smoothVolume(sampledFrom<double>(geometry, ramp), 0.5);
        const auto view = sloped.view().as<double>();
        SCOPED_TRACE(name);
        const ImageGeometry& image = geometry;  // Clang 14 captures no part of a pair
        forEachVoxel(geometry, [&](std::size_t n, const Vec3& point) {
            EXPECT_NEAR(flat.view().as<float>().samples[n], -1024, 1e-3);  // rounding
            const Vec3 index = image.toIndex(point);
            for (int axis = 0; axis < 3; ++axis) {
                // ten sigma, and what diagonal steps add, from the border: 1e-8 of the weight
                const double margin = 5 / image.spacingMm()[axis];
                if (index[axis] < margin) return;
                if (index[axis] > static_cast<double>(image.size[axis] - 1) - margin) return;
            }
            EXPECT_NEAR(view.samples[n], ramp(point), 1e-6);
        });
    }
}

TEST(Smooth, GivesFloatsThatHoldTheSamples) {
    const ImageGeometry geometry = centredGeometry({5, 5, 5});
    const auto typeOf = [&](auto zero) {
        return smoothVolume(sampledFrom<decltype(zero)>(geometry, [](auto) { return 1; }), 0.5)
            .view()
            .pixelType();
    };
    EXPECT_EQ(typeOf(std::uint8_t{}), PixelType::Float32);
    EXPECT_EQ(typeOf(std::int16_t{}), PixelType::Float32);
    EXPECT_EQ(typeOf(float{}), PixelType::Float32);
    EXPECT_EQ(typeOf(std::int32_t{}), PixelType::Float64);
    EXPECT_EQ(typeOf(std::uint64_t{}), PixelType::Float64);
    EXPECT_EQ(typeOf(double{}), PixelType::Float64);
}

TEST(Smooth, OwnsItsResultHoweverNarrowTheGaussian) {
    const ImageGeometry geometry = centredGeometry({4, 4, 4});
    const Volume volume = sampledFrom<float>(geometry, [](const Vec3& p) { return p.x; });
    const Volume smooth = smoothVolume(volume, 1e-5);
    EXPECT_NE(smooth.view().samples(), volume.view().samples());
    EXPECT_EQ(std::memcmp(smooth.view().samples(), volume.view().samples(), 64 * sizeof(float)), 0);
}

TEST(Smooth, DoesNotDependOnTheNumberOfThreads) {
    const Volume noise = randomVolume<std::int16_t>({40, 30, 20}, 1000, 3);
    const auto bytes = [&](int threads) {
        const ThreadLimitGuard limit(threads);
        const Volume smooth = smoothVolume(noise, 1.2);
        const auto* first = static_cast<const char*>(smooth.view().samples());
        return std::string(first, first + smooth.view().byteCount());
    };
    const std::string one = bytes(1);
    EXPECT_EQ(one, bytes(2));
    EXPECT_EQ(one, bytes(7));
}

TEST(Smooth, TakesTheWidestGaussianThatIsAllowed) {
    // its weights reach beyond the image on both sides
    const Volume volume = sampledFrom<float>(shearedGeometry({9, 8, 7}, {1, 1, 1}),
                                             [](const Vec3& p) { return p.x > 0 ? 1 : 0; });
    const Volume smooth = smoothVolume(volume, 1.75);
    const ValueRange range = valueRange(smooth);
    EXPECT_GE(range.minimum, 0);
    EXPECT_LE(range.maximum, 1 + 1e-6);  // rounding
}

TEST(Smooth, RefusesWhatCantBeSmoothed) {
    const ImageGeometry geometry = centredGeometry({8, 8, 4}, {1, 1, 2});  // 8 mm wide
    const Volume volume = sampledFrom<float>(geometry, [](auto) { return 0; });
    EXPECT_NO_THROW(smoothVolume(volume, 2));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double sigma : {0.0, -1.0, 2.1, nan}) {
        EXPECT_THROW(smoothVolume(volume, sigma), InvalidInput) << sigma;
    }
    for (const double odd : {nan, std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(smoothVolume(sampledFrom<float>(geometry, [&](auto) { return odd; }), 1),
                     InvalidInput);
    }
}

Volume randomVolume(const ImageGeometry& geometry) {
    std::uint64_t seed = 7;
    return sampledFrom<float>(
        geometry, [&](const Vec3&) { return static_cast<double>(nextRandom(seed) % 1000) / 1000; });
}

TEST(SmoothRecursively, IsNearlyTheGaussianForAnySigma) {
    for (const auto& [name, geometry] : kindsOfGrid({41, 37, 33}, {0.8, 1, 1.2})) {
        if (name == "sheared") continue;
        const Volume volume = randomVolume(geometry);
        for (const double sigmaMm : {2.0, 4.0}) {
            const Volume exact = smoothVolume(volume, sigmaMm),
                         found = smoothVolumeRecursively(volume, sigmaMm);
            ASSERT_EQ(found.view().geometry(), geometry);
            const float* const expected = exact.view().as<float>().samples;
            const float* const samples = found.view().as<float>().samples;
            for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
                // 1 % of what samples differ by, and what a sampled Gaussian differs from a
                // discrete
                ASSERT_NEAR(samples[n], expected[n], 0.015) << name << ' ' << sigmaMm;
            }
        }
    }
}

TEST(SmoothRecursively, GivesTheSameBytesForAnyNumberOfThreads) {
    const Volume volume = randomVolume(obliqueGeometry({41, 37, 33}, {1, 1, 1}));
    const auto inThreads = [&](int threads) {
        const ThreadLimitGuard limit(threads);
        return smoothVolumeRecursively(volume, 1.5);
    };
    const Volume one = inThreads(1), three = inThreads(3);
    EXPECT_EQ(std::memcmp(one.view().samples(), three.view().samples(), one.view().byteCount()), 0);
}

TEST(SmoothRecursively, RefusesWhatTheFilterCannotDo) {
    const Volume volume = randomVolume(centredGeometry({9, 9, 9}));
    EXPECT_THROW(smoothVolumeRecursively(volume, 0), InvalidInput);
    EXPECT_THROW(smoothVolumeRecursively(volume, std::numeric_limits<double>::quiet_NaN()),
                 InvalidInput);
    EXPECT_THROW(smoothVolumeRecursively(randomVolume(shearedGeometry({9, 9, 9}, {1, 1, 1})), 1),
                 InvalidInput);
    EXPECT_THROW(smoothVolumeRecursively(randomVolume(centredGeometry({9, 9, 3})), 1),
                 InvalidInput);
    Volume infinite = sampledFrom<float>(centredGeometry({9, 9, 9}), [](const Vec3& p) {
        return p.x > 3 ? std::numeric_limits<float>::infinity() : 0;
    });
    EXPECT_THROW(smoothVolumeRecursively(infinite, 1), InvalidInput);
}

}  // namespace
}  // namespace adaptiso::testing
