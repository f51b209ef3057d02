#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr std::endian kBig = std::endian::big;

/// 4 x 3 x 2 int16; axes to the left, down and forward (FreeSurfer's coronal), centre at 5, 6, 7.
std::string mghFile(std::int16_t orientationIsKnown = 1, std::int32_t frames = 1) {
    std::string h(284, '\0');
    const std::int32_t numbers[] = {1, 4, 3, 2, frames, 4};
    for (std::size_t i = 0; i < 6; ++i) put(h, 4 * i, numbers[i], kBig);
    put(h, 28, orientationIsKnown, kBig);
    const float geometry[] = {2, 3, 4, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
    for (std::size_t i = 0; i < 15; ++i) put(h, 30 + 4 * i, geometry[i], kBig);
    return h + samplesOf(countingSamples<std::int16_t>(24), kBig);
}

TEST(Mgh, ReadsPlainAndGzippedFiles) {
    const TempFolder folder;
    for (const auto& file : {writeFile(folder / "x.mgh", mghFile()),
                             writeFile(folder / "x.mgz", gzipped(mghFile()))}) {
        const ReadVolume result = readVolume(file);
        EXPECT_EQ(result.format, "MGH");
        EXPECT_EQ(samplesIn<std::int16_t>(result.volume), countingSamples<std::int16_t>(24));
        const ImageGeometry& g = result.volume.view().geometry();
        // RAS origin = centre - M (2, 1.5, 1) with M = (-2, 0, 0 | 0, 0, -3 | 0, 4, 0):
        // (5, 6, 7) - (-4, 4, -4.5) = (9, 2, 11.5)
        expectNear(g.originMm, {-9, -2, 11.5}, 0);
        EXPECT_EQ(g.indexToPhysical.column[0], (Vec3{2, 0, 0}));
        EXPECT_EQ(g.indexToPhysical.column[1], (Vec3{0, 0, -3}));
        EXPECT_EQ(g.indexToPhysical.column[2], (Vec3{0, -4, 0}));
    }
}

TEST(Mgh, UnknownOrientationIsWarned) {
    const TempFolder folder;
    const ReadVolume result = readVolume(writeFile(folder / "x.mgh", mghFile(0)));
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_NE(result.warnings[0].text.find("orientation is not known"), std::string::npos);
}

TEST(Mgh, RefusesTruncatedAndFourDimensionalFiles) {
    const TempFolder folder;
    const std::string whole = mghFile();
    for (const std::size_t length : {100UL, 283UL, 284UL, whole.size() - 1}) {
        expectRefusal(writeFile(folder / "x.mgh", whole.substr(0, length)), "truncated");
    }
    expectRefusal(writeFile(folder / "x.mgh", mghFile(1, 5)), "holds 5 volumes");
}

}  // namespace
}  // namespace adaptiso::testing
