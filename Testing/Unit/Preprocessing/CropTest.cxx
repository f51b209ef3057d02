#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "Grids.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

template <class T>
class CropOf : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(CropOf, PixelTypes);

TYPED_TEST(CropOf, EveryPixelTypeKeepsItsSamplesAndType) {
    const ImageGeometry geometry = centredGeometry({5, 4, 3});
    std::vector<TypeParam> samples(60);
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = static_cast<TypeParam>(n);
    samples[1 + 5 + 20] = std::numeric_limits<TypeParam>::lowest();
    const Volume cropped =
        cropVolume(Volume::fromSamples(samples, geometry), {{{1, 4}, {1, 3}, {1, std::nullopt}}});
    const auto view = cropped.view().as<TypeParam>();
    ASSERT_EQ(cropped.view().pixelType(), pixelTypeOf<TypeParam>());
    ASSERT_EQ(view.geometry.size, (Index3{3, 2, 2}));
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 3; ++i) {
                EXPECT_EQ(view.at(i, j, k), samples[(i + 1) + 5 * (j + 1) + 20 * (k + 1)]);
            }
        }
    }
}

TEST(Crop, KeepsThePlaceOfEveryVoxel) {
    // each sample is its voxel's place along one direction: after cropping it must still be
    const auto along = [](const Vec3& point) { return point.x + 100 * point.y + 1e4 * point.z; };
    for (const auto& [name, geometry] : kindsOfGrid({9, 8, 7}, {0.7, 1.1, 2.9})) {
        const Volume cropped =
            cropVolume(sampledFrom<double>(geometry, along), {{{2, 7}, {3, 8}, {1, 4}}});
        const auto view = cropped.view().as<double>();
        ASSERT_EQ(view.geometry.size, (Index3{5, 5, 3}));
        EXPECT_EQ(view.geometry.indexToPhysical, geometry.indexToPhysical) << name;
        forEachVoxel(view.geometry, [&, &kind = name](std::size_t n, const Vec3& point) {
            EXPECT_NEAR(view.samples[n], along(point), 1e-9) << kind;  // values up to 1e5
        });
    }
}

TEST(Crop, TakesTheWholeImageByDefault) {
    const ImageGeometry geometry = obliqueGeometry({4, 5, 6}, {1, 2, 3});
    const Volume volume = sampledFrom<float>(geometry, [](const Vec3& p) { return p.x; });
    const Volume cropped = cropVolume(volume, {});
    EXPECT_EQ(cropped.view().geometry(), geometry);
    EXPECT_EQ(
        std::memcmp(cropped.view().samples(), volume.view().samples(), volume.view().byteCount()),
        0);
}

TEST(Crop, RefusesRangesThatLeaveTheImageOrKeepNoVolume) {
    const Volume volume = sampledFrom<float>(centredGeometry({4, 4, 4}), [](auto) { return 0; });
    const auto refusal = [&](const IndexRange& range) -> std::string {
        try {
            cropVolume(volume, {{{}, range, {}}});
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(refusal({0, 5}), "0:5 along j: the image has voxels 0:4");
    EXPECT_EQ(refusal({-1, 3}), "-1:3 along j: the image has voxels 0:4");
    EXPECT_EQ(refusal({2, 3}), "2:3 along j: must keep 2 voxels or more");
    EXPECT_EQ(refusal({3, 1}), "3:1 along j: must keep 2 voxels or more");
    EXPECT_EQ(refusal({9, std::nullopt}), "9:4 along j: must keep 2 voxels or more");
    EXPECT_EQ(refusal({2, 4}), "none");
}

}  // namespace
}  // namespace adaptiso::testing
