#include <gtest/gtest.h>

#include <limits>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::testing {

template <class T>
class PixelTypes : public ::testing::Test {};
using AllPixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(PixelTypes, AllPixelTypes);

TYPED_TEST(PixelTypes, GiveTheSameMeshForTheSameValues) {
    const AnalyticVolume bytes =
        sampled<std::uint8_t>(torus({}, 7, 3), centredGeometry({26, 26, 12}));
    const auto view = bytes.volume.view().template as<std::uint8_t>();
    const std::vector<TypeParam> samples(view.samples, view.samples + view.geometry.voxelCount());
    const Volume volume = Volume::fromSamples(samples, view.geometry);
    for (const Method method : {Method::Boxes, Method::DiscretizedMarchingCubes,
                                Method::SkeletonClimbing, Method::MarchingCubes}) {
        EXPECT_EQ(extractFrom(volume, 60.5, method, 4, Border::Closed).mesh,
                  extractFrom(bytes.volume, 60.5, method, 4, Border::Closed).mesh);
    }
}

TYPED_TEST(PixelTypes, ReachTheirExtremeValues) {
    using Limits = std::numeric_limits<TypeParam>;
    ImageGeometry geometry;
    geometry.size = {3, 3, 3};
    std::vector<TypeParam> samples(27, Limits::lowest());
    samples[13] = Limits::max();
    const Volume volume = Volume::fromSamples(samples, geometry);
    const Extraction result = extractFrom(volume, 1, Method::Boxes, 2, Border::Closed);
    expectSound(result.mesh);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
}

TEST(Extraction, RefusesAnIndexOfAnotherVolume) {
    const HardVolume small = hardVolume(1, 5);
    const Volume other = Volume::fromSamples(std::vector<float>(8, 0.0F), [] {
        ImageGeometry geometry;
        geometry.size = {2, 2, 2};
        return geometry;
    }());
    const SpanSpaceIndex index = SpanSpaceIndex::build(other, {});
    EXPECT_THROW(extractSurface(small.volume, index, {}), InvalidInput);
}

TEST(Extraction, MakesAnIndexOfItsOwnForOneIsovalue) {
    const HardVolume hard = hardVolume(5, 9);
    ExtractionOptions options;
    options.isovalue = hard.isovalue;
    for (const Border border : {Border::Closed, Border::Open}) {
        EXPECT_EQ(extractSurface(hard.volume, options, border).mesh,
                  extractFrom(hard.volume, hard.isovalue, Method::Adaptive, 4, border).mesh);
    }
    EXPECT_FALSE(extractSurface(hard.volume, options).mesh.triangles.empty());
}

TEST(Extraction, RefusesOptionsOfAMethodThatIsNotChosen) {
    const HardVolume hard = hardVolume(3, 6);
    ExtractionOptions options;
    options.method = Method::MarchingCubes;
    options.adaptive.reduction = 0.5;
    EXPECT_THROW(extractSurface(hard.volume, options), InvalidInput);
    options.method = Method::Adaptive;
    options.discretized.adjustVertices = true;
    EXPECT_THROW(extractSurface(hard.volume, options), InvalidInput);
}

TEST(Extraction, RefusesVoxelsThatAreNeedles) {
    for (const double thinMm : {1e-3, 1e-7, 1e-38}) {
        ImageGeometry geometry;
        geometry.size = {4, 4, 4};
        geometry.indexToPhysical = Mat3::diagonal(thinMm, 2, 1);
        std::vector<float> samples(64, 0.0F);
        samples[21] = 1;
        const Volume volume = Volume::fromSamples(samples, geometry);
        const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {});
        for (const Method method : {Method::Adaptive, Method::MarchingCubes, Method::Boxes}) {
            ExtractionOptions options;
            options.isovalue = 0.5;
            options.method = method;
            if (thinMm < 1e-4) {
                EXPECT_THROW(extractSurface(volume, index, options), InvalidInput);
            } else {
                expectSound(extractSurface(volume, index, options).mesh);
            }
        }
    }
}

TEST(Extraction, RefusesAnIsovalueThatIsNoNumber) {
    const HardVolume hard = hardVolume(1, 5);
    const SpanSpaceIndex index = SpanSpaceIndex::build(hard.volume, {});
    ExtractionOptions options;
    for (const double isovalue :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        options.isovalue = isovalue;
        EXPECT_THROW(extractSurface(hard.volume, index, options), InvalidInput);
    }
}

TEST(Extraction, AnswersManyIsovaluesFromOneIndex) {
    const AnalyticVolume truth =
        sampled<std::uint8_t>(sphere({}, 10), centredGeometry({30, 30, 30}));
    const SpanSpaceIndex index = SpanSpaceIndex::build(truth.volume, {});
    double before = std::numeric_limits<double>::infinity();
    for (const double isovalue : {40.0, 50.0, 64.0, 80.0}) {
        ExtractionOptions options;
        options.isovalue = isovalue;
        const Extraction result = extractSurface(truth.volume, index, options);
        expectSound(result.mesh);
        EXPECT_LT(enclosedVolume(result.mesh), before);  // higher values lie deeper
        before = enclosedVolume(result.mesh);
    }
}

TEST(Extraction, LeavesNormalsOutWhenNotAsked) {
    const AnalyticVolume truth = sampled<float>(sphere({}, 5), centredGeometry({14, 14, 14}));
    const SpanSpaceIndex index = SpanSpaceIndex::build(truth.volume, {});
    ExtractionOptions options;
    options.isovalue = truth.isovalue;
    options.computeNormals = false;
    EXPECT_TRUE(extractSurface(truth.volume, index, options).mesh.normals.empty());
}

TEST(Extraction, CountsBlocksAndBoxes) {
    const AnalyticVolume truth = sampled<float>(sphere({}, 10), centredGeometry({32, 32, 32}));
    const Extraction result =
        extractFrom(truth.volume, truth.isovalue, Method::Boxes, 4, Border::Closed);
    const ExtractionStatistics& statistics = result.statistics;
    EXPECT_EQ(statistics.blocksTotal, 9 * 9 * 9);
    EXPECT_GT(statistics.blocksActive, 0);
    EXPECT_LE(statistics.blocksActive, statistics.blocksTotal);
    ASSERT_EQ(statistics.boxes.size(), 3u);
    EXPECT_EQ(statistics.boxes[0].size, 4);
    EXPECT_EQ(statistics.boxes[2].size, 1);
    EXPECT_EQ(statistics.boxes[2].shared, 0);  // nothing is finer than a unit box
}

TEST(Extraction, CountsRectangularBoxesByTheirLongestSide) {
    // a wall in one slab of open blocks of 4, the last of 3 cells: dikes of 4, 2 and 1 along x and
    // y, boxes as high as the volume (4 cells)
    ImageGeometry geometry;
    geometry.size = {8, 8, 5};
    std::vector<std::uint8_t> samples(8 * 8 * 5, 0);
    std::fill_n(samples.begin(), 8 * 8 * 2, 100);
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const Extraction result = extractFrom(volume, 50, Method::SkeletonClimbing, 4, Border::Open);
    ASSERT_EQ(result.statistics.boxes.size(), 4u);
    EXPECT_EQ(result.statistics.boxes[0].size, 4);
    EXPECT_EQ(result.statistics.boxes[0].unshared, 3 * 3);
    for (const BoxCount& count : result.statistics.boxes) EXPECT_EQ(count.shared, 0);
    EXPECT_EQ(result.statistics.marchingCubesTriangles, 2 * 7 * 7);
}

}  // namespace adaptiso::testing
