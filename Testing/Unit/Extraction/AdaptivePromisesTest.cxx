#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "AdaptivePromises.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Soundness.h"

namespace adaptiso::testing {

TEST(AdaptivePromises, HoldOnSmallVolumes) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, 8);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
    }
}

namespace {

/// With a bound of `boundVoxels`, and with a count alone.
void expectPromises(const AnalyticVolume& analytic, double boundVoxels) {
    const Vec3 spacing = analytic.volume.view().geometry().spacingMm();
    for (const Border border : {Border::Closed, Border::Open}) {
        AdaptiveCase adaptive{analytic.volume, analytic.isovalue, 4, border, {}};
        adaptive.options.maxErrorMm = boundVoxels * std::min({spacing.x, spacing.y, spacing.z});
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(0, adaptive);
        adaptive.options = {};
        adaptive.options.maxTriangles = 100;
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(0, adaptive);
    }
}

void expectPromisesOfShapes(const ImageGeometry& geometry) {
    const Vec3 spacing = geometry.spacingMm();
    const double radius = 5 * std::min({spacing.x, spacing.y, spacing.z});
    for (const double bound : {0.03, 0.25, 1.0}) {
        {
            SCOPED_TRACE("sphere");
            expectPromises(sampled<float>(sphere({}, radius), geometry), bound);
        }
        {
            SCOPED_TRACE("shell");
            expectPromises(sampled<std::uint8_t>(shell({}, 0.5 * radius, radius), geometry), bound);
        }
        {
            SCOPED_TRACE("torus");
            expectPromises(sampled<float>(torus({}, radius, 0.4 * radius), geometry), bound);
        }
        {
            SCOPED_TRACE("box");
            const Vec3 half{radius, 0.7 * radius, 0.8 * radius};
            expectPromises(sampled<std::int16_t>(box({}, half), geometry), bound);
        }
        {
            SCOPED_TRACE("half space");
            expectPromises(sampled<float>(halfSpace({}, {1, 2, 3}), geometry), bound);
        }
    }
}

}  // namespace

TEST(AdaptivePromises, HoldOnShapesInAStraightGrid) {
    expectPromisesOfShapes(centredGeometry({14, 15, 16}));
}

TEST(AdaptivePromises, HoldOnShapesInAnObliqueGrid) {
    expectPromisesOfShapes(obliqueGeometry({14, 13, 12}, {0.7, 0.9, 1.4}));
}

TEST(AdaptivePromises, HoldOnShapesInAShearedGrid) {
    expectPromisesOfShapes(shearedGeometry({14, 13, 12}, {1, 1, 2}));
}

TEST(AdaptivePromises, HoldOnShapesInAMirroredGrid) {
    expectPromisesOfShapes(mirroredGeometry({14, 16, 12}, {1, 0.5, 1}));
}

// The first brick is noise, which stays, the second is not: they meet at x = 32.
TEST(AdaptivePromises, HoldWhereNoiseMeetsASmoothSurface) {
    std::uint64_t state = 3;
    for (const ImageGeometry& geometry :
         {centredGeometry({38, 9, 8}), mirroredGeometry({38, 9, 8}, {1, 0.5, 1})}) {
        const Index3& size = geometry.size;
        std::vector<float> samples;
        for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
            const auto x = static_cast<double>(i % size[0]),
                       y = static_cast<double>(i / size[0] % size[1]),
                       z = static_cast<double>(i / (size[0] * size[1]));
            const double noise = static_cast<double>(nextRandom(state) % 2001) / 1000 - 1;
            samples.push_back(static_cast<float>(
                x < 31 ? noise : std::sin(0.9 * z + std::sin(0.4 * x)) + 0.2 * std::cos(0.7 * y)));
        }
        const Volume volume = Volume::fromSamples(std::move(samples), geometry);
        for (const Border border : {Border::Closed, Border::Open}) {
            for (const double bound : {0.1, 0.5}) {
                AdaptiveCase adaptive{volume, 0, 4, border, {}};
                adaptive.options.maxErrorMm = bound;
                EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(0, adaptive);
            }
        }
    }
}

namespace {

/// A sheet of waves across the volume, or a ball with waves, and single voxels on both sides of
/// it, off the border.
Volume amongSpecks(std::uint64_t seed, bool isBall) {
    const ImageGeometry geometry = centredGeometry({20, 21, 22});
    std::vector<float> samples;
    for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
        const auto x = static_cast<double>(n % 20) - 9.5, y = static_cast<double>(n / 20 % 21) - 10,
                   z = static_cast<double>(n / 420) - 10.5;
        const double waves = std::sin(1.1 * x + 0.4 * z) * std::cos(0.9 * y + 0.3);
        double value = isBall ? 6 - norm({x, y, z}) + waves : 1.5 * waves - z;
        const bool isWithin = std::abs(x) < 9 && std::abs(y) < 9 && std::abs(z) < 9;
        if (isWithin && nextRandom(seed) % 40 == 0) value = value > 0 ? -0.6 : 0.6;
        samples.push_back(static_cast<float>(value));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace

TEST(AdaptivePromises, HoldAmongSpecks) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        AdaptiveCase adaptive{amongSpecks(seed, seed % 2 == 0), 0, 4, Border::Closed, {}};
        for (const Border border : {Border::Closed, Border::Open}) {
            adaptive.border = border;
            for (const double reduction : {0.7, 0.8, 0.9, 1.0}) {
                adaptive.options = {};
                adaptive.options.reduction = reduction;
                EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
            }
            for (const double bound : {0.7, 1.5, 4.0}) {
                adaptive.options = {};
                adaptive.options.maxErrorMm = bound;
                EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
            }
        }
    }
}

// The sheet ends at the volume's border on all sides, so that each speck is above or below it.
TEST(AdaptivePromises, AnOpenSheetSweepsOverNoSpeck) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Volume volume = amongSpecks(seed, false);
        ExtractionOptions options;
        options.method = Method::MarchingCubes;
        const std::string nesting =
            nestingOf(extractSurface(volume.view(), options, Border::Open).mesh, true);
        options.method = Method::Adaptive;
        for (const double reduction : {0.7, 0.8, 0.9, 1.0}) {
            options.adaptive.reduction = reduction;
            const TriangleMesh mesh = extractSurface(volume.view(), options, Border::Open).mesh;
            EXPECT_EQ(nestingOf(mesh, true), nesting) << seed << ", " << reduction;
        }
    }
}

}  // namespace adaptiso::testing
