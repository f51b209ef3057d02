#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "Fixtures.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/WriteNifti.h"

namespace adaptiso::testing {
namespace {

template <class T>
Volume volumeOf(const ImageGeometry& geometry) {
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = static_cast<T>(7 * n);
    samples.back() = std::numeric_limits<T>::max();
    samples.front() = std::numeric_limits<T>::lowest();
    return Volume::fromSamples(std::move(samples), geometry);
}

void expectSame(const VolumeView& a, const VolumeView& b) {
    EXPECT_EQ(a.geometry(), b.geometry());
    ASSERT_EQ(a.pixelType(), b.pixelType());
    ASSERT_EQ(a.byteCount(), b.byteCount());
    EXPECT_EQ(std::memcmp(a.samples(), b.samples(), a.byteCount()), 0);
}

/// Oblique and mirrored, in numbers that float32 holds.
ImageGeometry floatGeometry() {
    return {{3, 4, 5}, {-10.5, 20.25, 3}, {{{{0.5, 0.25, 0}, {-0.25, 0.5, 0}, {0, 0, -2}}}}};
}

template <class T>
class WriteNifti : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(WriteNifti, PixelTypes);

TYPED_TEST(WriteNifti, IsReadAsItWas) {
    const TempFolder folder;
    const Volume volume = volumeOf<TypeParam>(floatGeometry());
    writeNifti(volume, folder.path() / "a.nii.gz");
    const ReadVolume read = readVolume(folder.path() / "a.nii.gz");
    EXPECT_EQ(read.format, "NIfTI-1");
    EXPECT_EQ(read.scaling, "");
    expectSame(read.volume, volume);
}

TEST(WriteNiftiVersion, IsTwoWhereOneWouldRound) {
    const TempFolder folder;
    ImageGeometry geometry = floatGeometry();
    geometry.originMm.y = 0.1;  // no float32
    const Volume volume = volumeOf<std::uint8_t>(geometry);
    writeNifti(volume, folder.path() / "a.nii.gz");
    ReadVolume read = readVolume(folder.path() / "a.nii.gz");
    EXPECT_EQ(read.format, "NIfTI-2");
    expectSame(read.volume, volume);

    const Volume longer = volumeOf<std::uint8_t>({{40'000, 2, 2}, {}, Mat3::diagonal(1, 1, 1)});
    writeNifti(longer, folder.path() / "a.nii.gz");
    read = readVolume(folder.path() / "a.nii.gz");
    EXPECT_EQ(read.format, "NIfTI-2");
    expectSame(read.volume, longer);
}

TEST(WriteNiftiFailure, NamesTheFile) {
    const Volume volume = volumeOf<std::uint8_t>(floatGeometry());
    try {
        writeNifti(volume, "/nowhere/a.nii.gz");
        FAIL() << "was written";
    } catch (const FileError& error) {
        EXPECT_STREQ(error.what(),
                     "/nowhere/a.nii.gz: can't be written: No such file or directory");
    }
}

}  // namespace
}  // namespace adaptiso::testing
