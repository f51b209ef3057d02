#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {
namespace {

template <class T>
class VolumeOfType : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(VolumeOfType, PixelTypes);

TYPED_TEST(VolumeOfType, DispatchesToItsOwnTypeXFastest) {
    const Volume volume = Volume::fromSamples<TypeParam>({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
                                                         testing::centredGeometry({3, 2, 2}));
    EXPECT_EQ(volume.view().pixelType(), pixelTypeOf<TypeParam>());
    EXPECT_EQ(volume.view().byteCount(), 12 * sizeof(TypeParam));
    EXPECT_EQ(bytesPerPixel(pixelTypeOf<TypeParam>()), sizeof(TypeParam));
    dispatchPixelType(volume, [](const auto& view) {
        EXPECT_TRUE((std::is_same_v<decltype(view.samples), const TypeParam*>));
        EXPECT_EQ(view.at(2, 0, 0), 2);
        EXPECT_EQ(view.at(0, 1, 0), 3);
        EXPECT_EQ(view.at(1, 1, 1), 10);
    });
}

TYPED_TEST(VolumeOfType, ValueRangeReachesTheLimitsOfTheType) {
    using Limits = std::numeric_limits<TypeParam>;
    const Volume volume = Volume::fromSamples<TypeParam>({5, Limits::lowest(), 7, Limits::max()},
                                                         testing::centredGeometry({4, 1, 1}));
    const ValueRange range = valueRange(volume);
    EXPECT_EQ(range.minimum, static_cast<double>(Limits::lowest()));
    EXPECT_EQ(range.maximum, static_cast<double>(Limits::max()));
}

TEST(PixelType, HasANameForEachType) {
    EXPECT_EQ(toString(PixelType::UInt8), "uint8");
    EXPECT_EQ(toString(PixelType::Int16), "int16");
    EXPECT_EQ(toString(PixelType::UInt64), "uint64");
    EXPECT_EQ(toString(PixelType::Float32), "float32");
    EXPECT_EQ(toString(PixelType::Float64), "float64");
}

TEST(Volume, RefusesASizeThatDiffersFromTheSamples) {
    EXPECT_THROW(Volume::fromSamples<float>({1, 2, 3}, testing::centredGeometry({2, 2, 1})),
                 InvalidInput);
}

TEST(Volume, RefusesAnAxisWithoutVoxels) {
    const float sample = 0;
    try {
        VolumeView(&sample, testing::centredGeometry({1, 0, 1}));
        FAIL() << "accepted";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("0 voxels along an axis"), std::string::npos);
    }
}

TEST(Volume, RefusesAxesThatSpanNothing) {
    const float sample = 0;
    ImageGeometry geometry = testing::centredGeometry({1, 1, 1});
    geometry.indexToPhysical.column[1] = geometry.indexToPhysical.column[0];
    EXPECT_THROW(VolumeView(&sample, geometry), InvalidInput);
    geometry.indexToPhysical = Mat3::diagonal(1, 1, std::nan(""));
    EXPECT_THROW(VolumeView(&sample, geometry), InvalidInput);
    geometry = testing::centredGeometry({1, 1, 1});
    geometry.originMm.x = std::numeric_limits<double>::infinity();
    EXPECT_THROW(VolumeView(&sample, geometry), InvalidInput);
}

TEST(Volume, KeepsItsSamplesAliveWhenCopied) {
    std::unique_ptr<Volume> first = std::make_unique<Volume>(
        Volume::fromSamples<std::int16_t>({1, 2, 3}, testing::centredGeometry({3, 1, 1})));
    const Volume copy = *first;
    first.reset();
    EXPECT_EQ(copy.view().as<std::int16_t>().at(2, 0, 0), 3);
}

TEST(ValueRange, LeavesNanAside) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const ImageGeometry geometry = testing::centredGeometry({4, 1, 1});
    const ValueRange some = valueRange(Volume::fromSamples<float>({nan, 3, -2, nan}, geometry));
    EXPECT_EQ(some.minimum, -2);
    EXPECT_EQ(some.maximum, 3);
    const ValueRange none = valueRange(Volume::fromSamples<float>({nan, nan, nan, nan}, geometry));
    EXPECT_EQ(none.minimum, std::numeric_limits<double>::infinity());
    EXPECT_EQ(none.maximum, -std::numeric_limits<double>::infinity());
}

TEST(ValueRange, IsInfiniteWhereAllSamplesAre) {
    const float far = std::numeric_limits<float>::infinity();
    const ImageGeometry geometry = testing::centredGeometry({3, 1, 1});
    for (const float value : {far, -far}) {
        const ValueRange range =
            valueRange(Volume::fromSamples<float>({value, value, value}, geometry));
        EXPECT_EQ(range.minimum, value);
        EXPECT_EQ(range.maximum, value);
    }
}

TEST(ValueRange, LooksAtEveryPieceOfALargeVolume) {
    std::vector<std::uint16_t> samples(3 * 1024 * 1024, 500);  // several pieces of work
    samples.front() = 7;
    samples.back() = 60000;
    const ValueRange range = valueRange(
        Volume::fromSamples(std::move(samples), testing::centredGeometry({1024, 1024, 3})));
    EXPECT_EQ(range.minimum, 7);
    EXPECT_EQ(range.maximum, 60000);
}

}  // namespace
}  // namespace adaptiso
