#include <gtest/gtest.h>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

const ReadOptions kResample{.resampleSlices = true};

void writeSlicesAt(const TempFolder& folder, const std::vector<double>& heights,
                   const Vec3& perMm = {0, 0, 1}, const Vec3& alongColumn = {0, 1, 0}) {
    for (std::size_t k = 0; k < heights.size(); ++k) {
        writeFile(folder / std::to_string(k),
                  fieldSlice(tellTale, Vec3{1, 2, 3} + heights[k] * perMm, {1, 0, 0}, alongColumn)
                      .file());
    }
}

TEST(ResampleSlices, UnevenOnesAreRefusedWithAHint) {
    const TempFolder folder;
    writeSlicesAt(folder, {0, 2, 4, 9, 11});
    expectRefusal(folder.path(), "5 mm between slices 3 and 4 where 2 mm is usual");
    expectRefusal(folder.path(), "--resample-slices");
}

TEST(ResampleSlices, AMissingSliceIsCounted) {
    const TempFolder folder;
    writeSlicesAt(folder, {0, 2, 4, 10, 12});
    expectRefusal(folder.path(), "(2 slices are missing there)");
}

TEST(ResampleSlices, ALinearFieldComesBackExactly) {
    // linear between slices: blending two of them gives the field itself
    for (const auto& heights : {std::vector<double>{0, 2, 4, 9, 11},
                                {0, 1, 2, 3, 8, 13, 18},
                                {0, 3, 4, 5},
                                {0, 2, 4.5, 6.5}}) {
        const TempFolder folder;
        writeSlicesAt(folder, heights);
        const ReadVolume read = readVolume(folder.path(), kResample);
        const VolumeView& volume = read.volume;
        EXPECT_EQ(volume.pixelType(), PixelType::Float32);
        const ImageGeometry& g = volume.geometry();
        expectNear(g.toPhysical({0, 0, static_cast<double>(g.size[2] - 1)}),
                   {1, 2, 3 + heights.back()}, 1e-9);
        expectField(volume, tellTale, 0.01);  // float32 of values near 3e4: 0.002
        ASSERT_EQ(read.warnings.size(), 1U);
        EXPECT_NE(read.warnings[0].text.find("resampled to"), std::string::npos)
            << read.warnings[0].text;
    }
}

TEST(ResampleSlices, StepsAreTheUsualOnes) {
    const TempFolder folder;
    writeSlicesAt(folder, {0, 2, 4, 10, 12});
    const ReadVolume read = readVolume(folder.path(), kResample);
    EXPECT_EQ(read.volume.view().geometry().size[2], 7);
    expectNear(read.volume.view().geometry().indexToPhysical.column[2], {0, 0, 2}, 1e-12);
}

TEST(ResampleSlices, TiltStays) {
    const TempFolder folder;
    writeSlicesAt(folder, {0, 2, 4, 9, 11}, {0, 0, 1}, {0, 0.8, 0.6});
    const ReadVolume read = readVolume(folder.path(), kResample);
    expectNear(read.volume.view().geometry().indexToPhysical.column[1], {0, 0.6, 0.45}, 1e-12);
    expectField(read.volume, tellTale, 0.6);  // 0.5: the slices' own rounding
    EXPECT_EQ(read.warnings.size(), 2U);
}

TEST(ResampleSlices, EvenOnesStayAsTheyAre) {
    const TempFolder folder;
    writeSlicesAt(folder, {0, 2, 4, 6});
    const ReadVolume read = readVolume(folder.path(), kResample);
    EXPECT_EQ(read.volume.view().pixelType(), PixelType::UInt16);
    EXPECT_TRUE(read.warnings.empty());
}

TEST(ResampleSlices, DoesNotExcuseSlicesBesideTheLineOrFarAway) {
    const TempFolder beside;
    writeSlicesAt(beside, {0, 2, 5, 7});
    writeFile(beside / "x", fieldSlice(tellTale, {1.2, 2, 6}).file());
    expectRefusal(beside.path(), "beside the line", kResample);
    const TempFolder far;
    writeSlicesAt(far, {0, 2, 4, 1000});
    expectRefusal(far.path(), "too far apart", kResample);
}

}  // namespace
}  // namespace adaptiso::testing
