#include <gtest/gtest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "Grids.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Preprocessing/LabelValues.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

TriangleMesh surfaceOf(const VolumeView& volume, double isovalue) {
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {});
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::MarchingCubes;
    return extractSurface(volume, index, options).mesh;
}

/// The middle of what a closed surface encloses.
Vec3 centroidOf(const TriangleMesh& mesh) {
    Vec3 sum;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
        sum += dot(p, cross(q, r)) / 24 * (p + q + r);
    }
    return (1 / enclosedVolume(mesh)) * sum;
}

TEST(Preprocess, KeepsASphereItsVolumeAndPlaceOnEveryKindOfGrid) {
    constexpr double kRadius = 15, kPi = 3.14159265358979;
    const Vec3 centre{1.3, -2.1, 0.7};
    for (const auto& [name, geometry] : kindsOfGrid({91, 61, 25}, {0.6, 0.9, 2})) {
        for (const auto interpolation : {Interpolation::Linear, Interpolation::BSpline}) {
            const AnalyticVolume ball = sampled<float>(sphere(centre, kRadius), geometry);
            PreprocessOptions options;
            options.crop = {{{5, 88}, {3, 59}, {1, 24}}};  // 3 mm around the ball are left
            options.smoothSigmaMm = 0.8;
            options.resampleMm = 0.7;
            options.interpolation = interpolation;
            const Preprocessed done = preprocess(ball.volume, options);
            const TriangleMesh mesh = surfaceOf(done.volume, ball.isovalue);

            // smoothing draws the surface in by sigma^2 / R = 0.043 mm; linear interpolation by at
            // most h^2 / 8 R an axis, 0.043 mm in the image (a spline hardly) and 0.012 mm in the
            // grid, by half of these on the mean
            const double inwards = 0.8 * 0.8 / kRadius;
            const double meanRadius = std::cbrt(enclosedVolume(mesh) / (4 * kPi / 3));
            EXPECT_LT(meanRadius, kRadius - inwards + 0.003) << name;
            EXPECT_GT(meanRadius, kRadius - inwards - 0.04) << name;
            EXPECT_LT(norm(centroidOf(mesh) - centre), 0.01) << name;
            for (const Vec3& point : mesh.points) {
                EXPECT_NEAR(norm(point - centre), kRadius - inwards, 0.06) << name;
            }
        }
    }
}

TEST(Preprocess, TakesItsStepsInTheStatedOrder) {
    const Volume noise = randomVolume<std::int16_t>({30, 25, 20}, 1000, 5);
    PreprocessOptions options;
    options.crop = {{{2, 28}, {}, {3, 18}}};
    options.smoothSigmaMm = 1;
    options.resampleMm = 1.5;
    const Volume done = preprocess(noise, options).volume;
    const Volume byHand = resampleVolume(smoothVolume(cropVolume(noise, *options.crop), 1), 1.5,
                                         Interpolation::Linear);
    ASSERT_EQ(done.view().geometry(), byHand.view().geometry());
    EXPECT_EQ(std::memcmp(done.view().samples(), byHand.view().samples(), done.view().byteCount()),
              0);
}

TEST(Preprocess, SaysWhichStepTheVolumeCantTake) {
    PreprocessOptions crop, smooth, resample;
    crop.crop = {{{0, 99}, {}, {}}};
    smooth.smoothSigmaMm = 99;
    resample.resampleMm = 99;
    const std::vector<std::pair<PreprocessOptions, PreprocessStep>> cases{
        {crop, PreprocessStep::Crop},
        {smooth, PreprocessStep::Smooth},
        {resample, PreprocessStep::Resample}};
    for (const auto& [options, step] : cases) {
        try {
            preprocess(randomVolume<std::int16_t>({5, 5, 5}, 10, 1), options);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const PreprocessError& error) {
            EXPECT_EQ(error.step(), step);
            EXPECT_EQ(std::string(error.what()).find("Volume"), std::string::npos) << error.what();
        }
    }
}

TEST(Preprocess, WithoutOptionsGivesTheVolumeBack) {
    const Volume volume = randomVolume<std::int16_t>({5, 5, 5}, 10, 1);
    const Preprocessed done = preprocess(volume, {});
    EXPECT_EQ(done.volume.view().samples(), volume.view().samples());
    EXPECT_TRUE(done.warnings.empty());
    EXPECT_TRUE(PreprocessOptions{}.changesNothing());
}

TEST(Preprocess, WarnsOfBlendedLabelsOnly) {
    // regions of 4 x 1 x 1 voxels at least, beside a background that fills half of the image
    const auto warningsOf = [](int distinctValues, const PreprocessOptions& options) {
        const ImageGeometry geometry = centredGeometry({24, 24, 24}, {1, 1, 1});
        const auto label = [&](const Vec3& p) {
            const Vec3 index = geometry.toIndex(p);
            const auto at = [&](int axis) { return static_cast<int>(std::round(index[axis])); };
            if (at(2) < 12) return 0;
            return (37 * (at(0) / 4) + 6 * at(1) + 144 * (at(2) - 12)) % distinctValues;
        };
        return preprocess(sampledFrom<std::uint8_t>(geometry, label), options).warnings;
    };
    PreprocessOptions smooth, resample, nearest, crop;
    smooth.smoothSigmaMm = 1;
    resample.resampleMm = nearest.resampleMm = 2;
    nearest.interpolation = Interpolation::Nearest;
    crop.crop = CropRanges{};
    ASSERT_EQ(warningsOf(7, smooth).size(), 1U);
    EXPECT_NE(warningsOf(7, smooth)[0].text.find("7 different whole numbers"), std::string::npos);
    EXPECT_EQ(warningsOf(7, resample).size(), 1U);
    EXPECT_EQ(warningsOf(100, resample).size(), 1U);
    EXPECT_TRUE(warningsOf(7, nearest).empty());
    EXPECT_TRUE(warningsOf(7, crop).empty());
    EXPECT_EQ(warningsOf(200, resample).size(), 1U);  // atlases have as many
    EXPECT_TRUE(warningsOf(2, smooth).empty());       // a mask
}

TEST(Preprocess, FewGreyValuesOfAScanAreNoLabels) {
    PreprocessOptions smooth;
    smooth.smoothSigmaMm = 1;
    for (const int greyValues : {20, 81, 100}) {
        // a head in air: half of the image is 0, the rest changes from voxel to voxel
        const Volume noise = randomVolume<std::uint8_t>({24, 24, 24}, greyValues, 1);
        const std::uint8_t* const first = noise.view().as<std::uint8_t>().samples;
        std::vector<std::uint8_t> samples(first, first + noise.view().geometry().voxelCount());
        std::fill_n(samples.begin(), samples.size() / 2, std::uint8_t{0});
        const Volume head = Volume::fromSamples(samples, noise.view().geometry());
        EXPECT_TRUE(preprocess(head, smooth).warnings.empty()) << greyValues;
    }
}

TEST(LabelValues, AreOfWholeNumbersThatFillRegions) {
    const ImageGeometry geometry = centredGeometry({24, 24, 24}, {1, 1, 1});
    const auto slabs = [&](auto type, std::vector<int> values) {
        using T = decltype(type);
        return sampledFrom<T>(geometry, [&, values](const Vec3& p) {
            const auto slab = static_cast<std::size_t>(std::round(geometry.toIndex(p).x) / 6);
            return static_cast<T>(values[slab]);
        });
    };
    const auto labels = findLabelValues(slabs(std::uint8_t{}, {0, 2, 7, 1}));
    ASSERT_TRUE(labels);
    EXPECT_EQ(labels->count, 4U);
    EXPECT_EQ(labels->first, 1);
    EXPECT_EQ(findLabelValues(slabs(std::int16_t{}, {-5, 3, 3000, 0}))->first, 0);
    EXPECT_EQ(findLabelValues(slabs(float{}, {0, 41, 2, 2}))->first,
              2);  // as some programs store them
    EXPECT_FALSE(findLabelValues(slabs(std::uint8_t{}, {0, 1, 1, 0})));  // a mask
    EXPECT_FALSE(findLabelValues(slabs(std::uint8_t{}, {0, 255, 255, 0})));
    EXPECT_FALSE(findLabelValues(slabs(std::uint8_t{}, {3, 3, 3, 3})));
    EXPECT_FALSE(findLabelValues(slabs(std::int16_t{}, {-1000, 0, 40, 1000})));  // a phantom
    const auto scan = [&](double level, auto type) {  // smooth: values change by one step
        using T = decltype(type);
        return sampledFrom<T>(geometry, [=](const Vec3& p) {
            return static_cast<T>(std::floor(std::max(0.0, 10 - norm(p)) * level));
        });
    };
    for (const double level : {1.0, 2.0, 8.0}) {
        EXPECT_FALSE(findLabelValues(scan(level, std::uint8_t{}))) << level;
        EXPECT_FALSE(findLabelValues(scan(level, float{}))) << level;
    }
    const auto fractions = sampledFrom<float>(geometry, [](const Vec3& p) {
        return p.x < 0 ? 0.F : p.y < 0 ? 0.5F : 1.F;
    });
    EXPECT_FALSE(findLabelValues(fractions));
}

TEST(Preprocess, WarnsWhenResamplingStraightensAShear) {
    PreprocessOptions options;
    options.resampleMm = 1;
    const auto warningsOf = [&](const ImageGeometry& geometry) {
        return preprocess(sampledFrom<float>(geometry, [](const Vec3& p) { return p.x; }), options)
            .warnings.size();
    };
    EXPECT_EQ(warningsOf(shearedGeometry({12, 12, 12}, {1, 1, 2})), 1U);
    EXPECT_EQ(warningsOf(obliqueGeometry({12, 12, 12}, {1, 1, 2})), 0U);
    EXPECT_EQ(warningsOf(mirroredGeometry({12, 12, 12}, {1, 1, 2})), 0U);
}

}  // namespace
}  // namespace adaptiso::testing
