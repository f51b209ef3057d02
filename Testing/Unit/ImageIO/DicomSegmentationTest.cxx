// DICOM SEG: frames left out are empty, one bit a pixel, segments.
#include <gtest/gtest.h>

#include <algorithm>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kMaskColumns = 5, kMaskRows = 3;  // 15 pixels: frames do not begin at whole bytes
constexpr double kStepMm = 2.5;

struct Frame {
    int place, segment;
};

bool isInside(int segment, int i, int j, int k) {
    return (i * 3 + j * 5 + k * 7 + segment * 2) % 4 < 2;
}

enum class Bits { Packed, Bytes };

DicomBuilder segmentation(const std::vector<Frame>& frames, Bits bits,
                          const std::string& spacing = "2.5") {
    std::vector<DicomBuilder> groups;
    std::string pixels;
    std::size_t bit = 0;
    for (const auto& [k, segment] : frames) {
        DicomBuilder plane, identification, group;
        plane.text(0x00200032, "DS", dicomText({1, 2, 3 + kStepMm * k}));
        identification.us(0x0062000B, static_cast<std::uint16_t>(segment));
        groups.push_back(
            group.sequence(0x00209113, {plane}).sequence(0x0062000A, {identification}));
        for (int j = 0; j < kMaskRows; ++j) {
            for (int i = 0; i < kMaskColumns; ++i, ++bit) {
                const bool is = isInside(segment, i, j, k);
                if (bits == Bits::Bytes) {
                    pixels += static_cast<char>(is ? 255 : 0);
                    continue;
                }
                if (bit % 8 == 0) pixels += '\0';
                if (is) pixels.back() = static_cast<char>(pixels.back() | 1 << bit % 8);
            }
        }
    }
    DicomBuilder orientation, measures, shared;
    orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    measures.text(0x00280030, "DS", "0.75\\0.5").text(0x00180088, "DS", spacing);
    shared.sequence(0x00209116, {orientation}).sequence(0x00289110, {measures});
    std::vector<DicomBuilder> segments;
    for (const int number : {1, 2}) {
        segments.emplace_back()
            .us(0x00620004, static_cast<std::uint16_t>(number))
            .text(0x00620005, "LO", number == 1 ? "Liver" : "Left kidney");
    }
    DicomBuilder image = dicomImage(kMaskColumns, kMaskRows);
    const auto depth = static_cast<std::uint16_t>(bits == Bits::Packed ? 1 : 8);
    image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4")
        .text(0x00080060, "CS", "SEG")
        .text(0x00280008, "IS", std::to_string(frames.size()))
        .us(0x00280100, depth)
        .us(0x00280101, depth)
        .us(0x00280102, static_cast<std::uint16_t>(depth - 1))
        .text(0x00620001, "CS", bits == Bits::Packed ? "BINARY" : "FRACTIONAL")
        .sequence(0x00620002, segments)
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, groups)
        .bytes(0x7FE00010, "OB", pixels + std::string(pixels.size() % 2, '\0'));
    return image;
}

/// Expects the segment's frames at their places and 0 elsewhere, from place `first` to `last`.
void expectSegment(const ReadVolume& read, const std::vector<Frame>& frames, int segment, int first,
                   int last, std::uint8_t inside) {
    const ImageGeometry& geometry = read.volume.view().geometry();
    ASSERT_EQ(geometry.size, (Index3{kMaskColumns, kMaskRows, last - first + 1}));
    expectNear(geometry.originMm, {1, 2, 3 + kStepMm * first}, 1e-9);
    EXPECT_EQ(geometry.indexToPhysical, Mat3::diagonal(0.5, 0.75, kStepMm));
    const auto view = read.volume.view().as<std::uint8_t>();
    for (int k = first; k <= last; ++k) {
        const bool isThere = std::ranges::any_of(frames, [&](const Frame& frame) {
            return frame.place == k && frame.segment == segment;
        });
        for (int j = 0; j < kMaskRows; ++j) {
            for (int i = 0; i < kMaskColumns; ++i) {
                const bool is = isThere && isInside(segment, i, j, k);
                ASSERT_EQ(view.at(i, j, k - first), is ? inside : 0) << i << ' ' << j << ' ' << k;
            }
        }
    }
}

TEST(DicomSegmentation, FramesLeftOutAreEmpty) {
    const std::vector<Frame> frames{{7, 1}, {3, 1}, {4, 1}, {8, 1}};
    for (const char* syntax :
         {kExplicitLittleEndian, kImplicitLittleEndian, kDeflatedLittleEndian}) {
        for (const Bits bits : {Bits::Packed, Bits::Bytes}) {
            for (const char* spacing : {"2.5", "", "4"}) {  // absent or wrong: from the positions
                const TempFolder folder;
                const auto file =
                    writeFile(folder / "x", segmentation(frames, bits, spacing).file(syntax));
                for (const bool resamples : {false, true}) {
                    const ReadVolume read = readVolume(file, {.resampleSlices = resamples});
                    expectSegment(read, frames, 1, 3, 8, bits == Bits::Packed ? 1 : 255);
                    EXPECT_TRUE(read.warnings.empty());
                }
            }
        }
    }
}

TEST(DicomSegmentation, FramesWithoutNeighboursAreToldOf) {
    const TempFolder folder;
    const std::vector<Frame> frames{{2, 1}, {6, 1}};
    const ReadVolume read =
        readVolume(writeFile(folder / "x", segmentation(frames, Bits::Packed).file()));
    expectSegment(read, frames, 1, 2, 6, 1);
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("2.5 mm apart"), std::string::npos);
}

TEST(DicomSegmentation, SegmentsAreListedAndChosen) {
    const TempFolder folder;
    const std::vector<Frame> frames{{1, 2}, {0, 1}, {2, 2}, {1, 1}, {5, 1}};
    const auto file = writeFile(folder / "x", segmentation(frames, Bits::Packed).file());
    const std::string message = refusalOf(file);
    EXPECT_NE(message.find("segment 1 'Liver'"), std::string::npos) << message;
    EXPECT_NE(message.find("segment 2 'Left kidney'"), std::string::npos) << message;
    EXPECT_NE(message.find("--series"), std::string::npos) << message;
    const DicomListing listing = listSeries(file);
    ASSERT_EQ(listing.series.size(), 2U);
    for (const DicomSeries& series : listing.series) {
        ASSERT_TRUE(series.segment.has_value());
        const int segment = static_cast<int>(*series.segment);
        EXPECT_EQ(series.segmentLabel, segment == 1 ? "Liver" : "Left kidney");
        EXPECT_EQ(series.slices, 6);
        EXPECT_TRUE(series.isReadable()) << series.fault;
        const ReadVolume read = readVolume(file, {.series = std::to_string(series.number)});
        expectSegment(read, frames, segment, 0, 5, 1);
    }
    expectRefusal(file, "the asked-for series holds 2 groups", {.series = "1.2.3.4"});
    expectRefusal(file, "not one of these", {.series = "3"});
}

TEST(DicomSegmentation, BesideTheScanIsLeftAside) {
    const TempFolder folder;
    for (int k = 0; k < 3; ++k) {
        writeFile(folder / std::to_string(k), fieldSlice(tellTale, {1, 2, 3.0 + 2 * k}).file());
    }
    DicomBuilder seg = segmentation({{0, 1}, {1, 1}, {3, 2}}, Bits::Packed);
    writeFile(folder / "seg", seg.text(0x0020000E, "UI", "7.7").file());
    const ReadVolume read = readVolume(folder.path());
    expectField(read.volume, tellTale);
    EXPECT_EQ(read.warnings.size(), 2U);
    EXPECT_EQ(readVolume(folder.path(), {.series = "2"}).volume.view().geometry().size[2], 4);
}

TEST(DicomSegmentation, RefusesWhatCannotBePlaced) {
    const TempFolder folder;
    const auto refused = [&](const DicomBuilder& image, std::string_view fault) {
        expectRefusal(writeFile(folder / "x", image.file()), fault);
    };
    const std::vector<Frame> frames{{0, 1}, {1, 1}, {2, 1}};
    refused(segmentation({{0, 1}, {0, 1}, {1, 1}}, Bits::Packed), "at the same position");
    refused(segmentation({{3, 1}}, Bits::Packed), "its frames all lie at the same position");
    refused(segmentation({{0, 1}, {1, 1}, {20000, 1}}, Bits::Packed), "span 20001 slices");
    // 3 x 15 bits are 6 bytes
    refused(segmentation(frames, Bits::Packed).bytes(0x7FE00010, "OB", std::string(4, '\1')),
            "hold 4 of 6 bytes");
    refused(segmentation(frames, Bits::Packed).bytes(0x7FE00010, "OB", std::string(8, '\1')),
            "each may be padded");
    refused(segmentation(frames, Bits::Packed).fragments({"xx", "xx", "xx"}), "damaged");
    refused(segmentation(frames, Bits::Packed).us(0x00280101, 8), "pixel bits");
    expectRefusal(
        writeFile(folder / "x", segmentation(frames, Bits::Packed).file(kExplicitBigEndian)),
        "1 a pixel, big endian");
    expectRefusal(
        writeFile(
            folder / "x",
            segmentation(frames, Bits::Packed).fragments({"xx", "xx", "xx"}).file(kRleLossless)),
        "1 a pixel, compressed");
}

}  // namespace
}  // namespace adaptiso::testing
