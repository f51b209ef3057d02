#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kFrames = 5;

/// Frame n lies at place order[n].
constexpr int kOrder[kFrames] = {3, 0, 4, 2, 1};

DicomBuilder positionGroup(const Vec3& position) {
    DicomBuilder plane;
    plane.text(0x00200032, "DS", dicomText(position));
    DicomBuilder group;
    group.sequence(0x00209113, {plane});
    return group;
}

DicomBuilder sharedGroup(const Vec3& alongRow = {1, 0, 0}, const Vec3& alongColumn = {0, 1, 0}) {
    DicomBuilder orientation, measures, group;
    orientation.text(0x00200037, "DS", dicomText(alongRow) + "\\" + dicomText(alongColumn));
    measures.text(0x00280030, "DS", "0.75\\0.5").text(0x00180050, "DS", "9");
    group.sequence(0x00209116, {orientation}).sequence(0x00289110, {measures});
    return group;
}

DicomBuilder rescaleGroup(DicomBuilder group, const std::string& slope,
                          const std::string& intercept) {
    DicomBuilder transformation;
    transformation.text(0x00281052, "DS", intercept).text(0x00281053, "DS", slope);
    group.sequence(0x00289145, {transformation});
    return group;
}

Vec3 placeOf(int frame) {
    return {1, 2, 3.0 + 2 * kOrder[frame]};
}

DicomBuilder enhanced(const std::vector<DicomBuilder>& perFrame, const DicomBuilder& shared,
                      const std::vector<std::uint16_t>& samples) {
    DicomBuilder image = dicomImage(kColumns, kRows);
    image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1")
        .text(0x00280008, "IS", std::to_string(perFrame.size()))
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, perFrame)
        .pixels(samples);
    return image;
}

void append(std::vector<std::uint16_t>& samples, const std::vector<std::uint16_t>& more) {
    samples.insert(samples.end(), more.begin(), more.end());
}

DicomBuilder shuffledImage() {
    std::vector<DicomBuilder> groups;
    std::vector<std::uint16_t> samples;
    for (int n = 0; n < kFrames; ++n) {
        groups.push_back(positionGroup(placeOf(n)));
        append(samples, sampleSlice(tellTale, kColumns, kRows, placeOf(n)));
    }
    return enhanced(groups, sharedGroup(), samples);
}

TEST(DicomEnhanced, FramesLieWhereTheirOwnPositionsSay) {
    for (const char* syntax : {kExplicitLittleEndian, kImplicitLittleEndian, kExplicitBigEndian,
                               kDeflatedLittleEndian}) {
        const TempFolder folder;
        const ReadVolume read = readVolume(writeFile(folder / "x", shuffledImage().file(syntax)));
        EXPECT_EQ(read.volume.view().geometry().size, (Index3{kColumns, kRows, kFrames})) << syntax;
        EXPECT_EQ(read.volume.view().geometry().indexToPhysical, Mat3::diagonal(0.5, 0.75, 2));
        expectField(read.volume, tellTale);
    }
}

TEST(DicomEnhanced, TiltedFramesKeepTheirShear) {
    const TempFolder folder;
    const Vec3 alongColumn{0, 0.8, 0.6};
    std::vector<DicomBuilder> groups;
    std::vector<std::uint16_t> samples;
    for (int n = 0; n < kFrames; ++n) {
        groups.push_back(positionGroup(placeOf(n)));
        append(samples, sampleSlice(tellTale, kColumns, kRows, placeOf(n), {1, 0, 0}, alongColumn));
    }
    const DicomBuilder image = enhanced(groups, sharedGroup({1, 0, 0}, alongColumn), samples);
    const ReadVolume read = readVolume(writeFile(folder / "x", image.file()));
    expectField(read.volume, tellTale, 0.5);  // samples are rounded
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("36.87 degrees"), std::string::npos)
        << read.warnings[0].text;
}

TEST(DicomEnhanced, RescaleIsTakenFromEveryFrameElseFromTheSharedGroupElseFromTheTop) {
    std::vector<std::uint16_t> samples;
    std::vector<DicomBuilder> own, none;
    for (int n = 0; n < kFrames; ++n) {
        own.push_back(rescaleGroup(positionGroup(placeOf(n)), std::to_string(1 << n), "-5"));
        none.push_back(positionGroup(placeOf(n)));
        append(samples, std::vector<std::uint16_t>(kColumns * kRows, 100));
    }
    const TempFolder folder;
    const auto valueAt = [&](const DicomBuilder& image, int frame) {
        const ReadVolume read = readVolume(writeFile(folder / "x", image.file()));
        return dispatchPixelType(read.volume, [&](const auto& view) {
            return static_cast<double>(view.at(1, 1, kOrder[frame]));
        });
    };
    for (int n = 0; n < kFrames; ++n) {
        EXPECT_EQ(valueAt(enhanced(own, sharedGroup(), samples), n), 100.0 * (1 << n) - 5);
    }
    const DicomBuilder shared = rescaleGroup(sharedGroup(), "3", "1");
    EXPECT_EQ(valueAt(enhanced(none, shared, samples), 2), 301);
    DicomBuilder top = enhanced(none, sharedGroup(), samples);
    top.text(0x00281052, "DS", "7").text(0x00281053, "DS", "2");
    EXPECT_EQ(valueAt(top, 2), 207);
}

TEST(DicomEnhanced, TimePointsAreVolumes) {
    const TempFolder folder;
    std::vector<DicomBuilder> groups;
    std::vector<std::uint16_t> samples;
    for (int n = 0; n < kFrames; ++n) {
        for (std::uint32_t t = 2; t > 0; --t) {  // the later one first
            DicomBuilder content, group = positionGroup(placeOf(n));
            content.ul(0x00209128, t);
            groups.push_back(group.sequence(0x00209111, {content}));
            append(samples, sampleSlice([&](const Vec3& p) { return tellTale(p) + 100 * t; },
                                        kColumns, kRows, placeOf(n)));
        }
    }
    const auto file = writeFile(folder / "x", enhanced(groups, sharedGroup(), samples).file());
    expectRefusal(file, "4-D image: 2 volumes at the same position (time points)");
    for (int v = 0; v < 2; ++v) {
        const ReadVolume read = readVolume(file, {.volumeIndex = v});
        expectField(read.volume, [v](const Vec3& p) { return tellTale(p) + 100 * (v + 1); });
    }
}

TEST(DicomEnhanced, EchoesAndPhaseImagesAreToldApart) {
    const TempFolder folder;
    std::vector<DicomBuilder> groups;
    std::vector<std::uint16_t> samples;
    for (int n = 0; n < kFrames; ++n) {
        for (int kind = 0; kind < 4; ++kind) {
            DicomBuilder echo, type, group = positionGroup(placeOf(n));
            echo.fd(0x00189082, 5.5 + kind % 2);
            type.text(0x00089007, "CS", "ORIGINAL\\PRIMARY\\VOLUME\\NONE")
                .text(0x00089208, "CS", kind / 2 ? "PHASE" : "MAGNITUDE");
            group.sequence(0x00189114, {echo}).sequence(0x00189226, {type});
            groups.push_back(group);
            append(samples, sampleSlice([&](const Vec3& p) { return tellTale(p) + 100 * kind; },
                                        kColumns, kRows, placeOf(n)));
        }
    }
    const auto file = writeFile(folder / "x", enhanced(groups, sharedGroup(), samples).file());
    expectRefusal(file, "2 groups of slices");
    expectRefusal(file, "2 volumes at the same position (echoes)", {.series = "2"});
    const ReadVolume read = readVolume(file, {.series = "2", .volumeIndex = 1});
    expectField(read.volume, [](const Vec3& p) { return tellTale(p) + 300; });
}

TEST(DicomEnhanced, SequencesOfUnknownTypeAreRead) {
    // once through a system that did not know the sequence: UN, its content in implicit form
    const TempFolder folder;
    std::string file = shuffledImage().file(kImplicitLittleEndian);
    ASSERT_NO_THROW(readVolume(writeFile(folder / "x", file)));
    file = shuffledImage().file();
    const std::string implicit = shuffledImage().file(kImplicitLittleEndian);
    const auto find = [](const std::string& bytes) {
        return bytes.find(std::string("\x00\x52\x30\x92", 4));
    };
    const auto length = [](const std::string& bytes, std::size_t at) {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        return value;
    };
    const std::size_t at = find(file), from = find(implicit);
    const std::string content = implicit.substr(from + 8, length(implicit, from + 4));
    file.replace(at, 12 + length(file, at + 8),
                 std::string("\x00\x52\x30\x92UN\0\0", 8) +
                     bytesOf(static_cast<std::uint32_t>(content.size())) + content);
    expectField(readVolume(writeFile(folder / "x", file)).volume, tellTale);
}

TEST(DicomEnhanced, RefusesFramesWithoutAPlace) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x", shuffledImage().without(0x52009230).file()),
                  "does not say where its frames lie");
    expectRefusal(writeFile(folder / "x", shuffledImage().without(0x52009229).file()),
                  "ImageOrientationPatient");
    const std::vector<std::uint16_t> ofFour(4 * kColumns * kRows);
    expectRefusal(
        writeFile(folder / "x", shuffledImage().text(0x00280008, "IS", "4").pixels(ofFour).file()),
        "4 frames but 5 functional groups");
    expectRefusal(writeFile(folder / "x", shuffledImage().text(0x00280008, "IS", "6").file()),
                  "of 144 bytes");  // 6 frames of 4 * 3 * 2 bytes
}

/// One frame of its own direction or kind after the other.
DicomBuilder manyKinds(int frames, bool byDirection) {
    std::vector<DicomBuilder> groups;
    for (int n = 0; n < frames; ++n) {
        const double angle = byDirection ? std::numbers::pi * n / frames : 0;
        groups.push_back(positionGroup({0, 0, byDirection ? 1.0 * n : 0}));
        DicomBuilder orientation, type;
        orientation.text(0x00200037, "DS",
                         dicomText({std::cos(angle), std::sin(angle), 0}) + "\\" +
                             dicomText({-std::sin(angle), std::cos(angle), 0}));
        type.text(0x00089007, "CS", byDirection ? "ORIGINAL" : "K" + std::to_string(n));
        groups.back().sequence(0x00209116, {orientation}).sequence(0x00189226, {type});
    }
    const std::vector<std::uint16_t> samples(static_cast<std::size_t>(frames * kColumns * kRows));
    return enhanced(groups, sharedGroup(), samples);
}

TEST(DicomEnhanced, OfMoreKindsThanAStudyHasIsRefused) {
    // 20,000 took 5 s to compare with one another
    for (const bool byDirection : {true, false}) {
        const TempFolder folder;
        const auto file = writeFile(folder / "x", manyKinds(1001, byDirection).file());
        expectRefusal(file, "differ in more than 1000 ways");
        EXPECT_THROW(listSeries(file), FileError);
        writeFile(file, manyKinds(1000, byDirection).file());
        expectRefusal(file, "and 988 more");  // not one volume, but all were compared
    }
}

}  // namespace
}  // namespace adaptiso::testing
