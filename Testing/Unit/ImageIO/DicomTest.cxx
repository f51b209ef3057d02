#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>

#include "Fixtures.h"
#include "GdcmWriter.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

/// Names that sort against the slices' positions: only the positions may count.
std::string scrambledName(int k) {
    return std::to_string((k * 7) % 10) + ".dcm";
}

void writeStack(const TempFolder& folder, int slices) {
    for (int k = 0; k < slices; ++k) writeFile(folder / scrambledName(k), stackedSlice(k).bytes());
}

TEST(DicomSeries, IsSortedAlongTheNormal) {
    const TempFolder folder;
    writeStack(folder, 4);
    writeFile(folder / "README.txt", "not DICOM, left alone");
    const ReadVolume result = readVolume(folder.path());
    const VolumeView& volume = result.volume;
    EXPECT_EQ(result.format, "DICOM");
    EXPECT_TRUE(result.warnings.empty());
    ASSERT_EQ(volume.pixelType(), PixelType::UInt16);
    ASSERT_EQ(volume.geometry().size, (Index3{3, 2, 4}));
    expectNear(volume.geometry().originMm, {10, 20, 30}, 0);
    // PixelSpacing 0.5 \ 0.25: rows are 0.5 mm apart (j), columns 0.25 mm (i)
    EXPECT_EQ(volume.geometry().indexToPhysical, Mat3::diagonal(0.25, 0.5, 2));
    for (int k = 0; k < 4; ++k) {
        EXPECT_EQ(volume.as<std::uint16_t>().at(2, 1, k), 100 * k + 5);
    }
}

TEST(DicomSeries, KeepsGantryTiltAsShear) {
    const TempFolder folder;
    for (int k = 0; k < 3; ++k) {
        DicomSlice slice = stackedSlice(k);
        // rows tilted about x by atan(3/4); the table moves along z: step 5 mm
        slice.orientation = "1\\0\\0\\0\\0.8\\0.6";
        slice.position = "0\\0\\" + std::to_string(5 * k);
        writeFile(folder / scrambledName(k), slice.bytes());
    }
    const ReadVolume result = readVolume(folder.path());
    const ImageGeometry& g = result.volume.view().geometry();
    expectNear(g.indexToPhysical.column[1], {0, 0.4, 0.3}, 1e-15);
    expectNear(g.indexToPhysical.column[2], {0, 0, 5}, 1e-15);
    ASSERT_EQ(result.warnings.size(), 1U);
    // normal (0, -0.6, 0.8), step along z: acos(0.8) = 36.87 degrees
    EXPECT_NE(result.warnings[0].text.find("36.87 degrees"), std::string::npos)
        << result.warnings[0].text;
}

TEST(DicomSeries, RefusesAMissingSliceAndNamesTheGap) {
    const TempFolder folder;
    for (const int k : {0, 1, 2, 4, 5}) {
        writeFile(folder / scrambledName(k), stackedSlice(k).bytes());
    }
    expectRefusal(folder.path(), "4 mm between slices 3 and 4 where 2 mm is usual");
}

TEST(DicomSeries, AcceptsRoundedPositionsAndRefusesUnevenOnes) {
    const auto stackWithThirdAt = [](const char* z) {
        auto folder = std::make_unique<TempFolder>();
        writeStack(*folder, 4);
        DicomSlice slice = stackedSlice(2);
        slice.position = std::string("10\\20\\") + z;
        writeFile(*folder / scrambledName(2), slice.bytes());
        return folder;
    };
    EXPECT_NO_THROW(readVolume(stackWithThirdAt("34.04")->path()));  // 0.05 mm is the promise
    expectRefusal(stackWithThirdAt("34.06")->path(), "uneven slice spacing");
}

TEST(DicomSeries, RefusesSlicesBesideTheLine) {
    const TempFolder folder;
    writeStack(folder, 4);
    DicomSlice slice = stackedSlice(2);
    slice.position = "10.1\\20\\34";
    writeFile(folder / scrambledName(2), slice.bytes());
    expectRefusal(folder.path(), "slice 3 lies 0.1 mm beside the line");
}

TEST(DicomSeries, RefusesRepeatedPositions) {
    const TempFolder folder;
    writeStack(folder, 3);
    DicomSlice again = stackedSlice(1);
    again.pixels[0] ^= 1;
    writeFile(folder / "again.dcm", again.bytes());
    expectRefusal(folder.path(), "same position");
}

TEST(DicomSeries, RefusesASingleSliceAsFolderAndAsFile) {
    const TempFolder folder;
    const auto file = writeFile(folder / "one", stackedSlice(0).bytes());
    expectRefusal(folder.path(), "single DICOM slice");
    expectRefusal(file, "single DICOM slice");
}

TEST(DicomSeries, ListsTwoSeriesWithoutIdsAndReadsTheChosenOne) {
    const TempFolder folder;
    writeStack(folder, 3);
    for (int k = 0; k < 2; ++k) {
        DicomSlice slice = stackedSlice(k);
        slice.seriesUid = "9.8.7.6";
        slice.orientation = "1\\0\\0\\0\\0\\-1";
        slice.position = "0\\" + std::to_string(k) + "\\0";
        writeFile(folder / ("z" + std::to_string(k)), slice.bytes());
    }
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("1: 3 slices of 3 x 2 voxels, axial"), std::string::npos) << message;
    EXPECT_NE(message.find("2: 2 slices of 3 x 2 voxels, coronal"), std::string::npos) << message;
    for (const char* secret : {"9.8.7.6", "1.2.3.4", "Secret", "Patient"}) {
        EXPECT_EQ(message.find(secret), std::string::npos) << message;
    }
    EXPECT_EQ(readVolume(folder.path(), {.series = "1"}).volume.view().geometry().size[2], 3);
    EXPECT_EQ(readVolume(folder.path(), {.series = "2"}).volume.view().geometry().size[2], 2);
    EXPECT_EQ(readVolume(folder.path(), {.series = "9.8.7.6"}).volume.view().geometry().size[2], 2);
    EXPECT_THROW(readVolume(folder.path(), {.series = "3"}), FileError);
}

TEST(DicomSeries, RefusesTwoSizesInOneSeries) {
    const TempFolder folder;
    writeStack(folder, 3);
    DicomSlice slice = stackedSlice(3);
    slice.rows = 3, slice.columns = 2;
    writeFile(folder / "other.dcm", slice.bytes());
    expectRefusal(folder.path(), "differ in series, size");
}

TEST(DicomRescale, WholeInterceptsStayIntegers) {
    const TempFolder folder;
    for (int k = 0; k < 2; ++k) {
        DicomSlice slice = stackedSlice(k);
        slice.rescaleSlope = "1";
        slice.rescaleIntercept = "-1024";
        writeFile(folder / scrambledName(k), slice.bytes());
    }
    const ReadVolume result = readVolume(folder.path());
    // 12 bits stored: -1024 ... 3071
    ASSERT_EQ(result.volume.view().pixelType(), PixelType::Int16);
    EXPECT_EQ(result.volume.view().as<std::int16_t>().at(1, 0, 1), 101 - 1024);
}

TEST(DicomRescale, IsTakenFromEverySlice) {
    const TempFolder folder;
    for (int k = 0; k < 2; ++k) {
        DicomSlice slice = stackedSlice(k);
        slice.rescaleSlope = k ? "0.5" : "0.25";
        slice.rescaleIntercept = "1";
        writeFile(folder / scrambledName(k), slice.bytes());
    }
    const ReadVolume result = readVolume(folder.path());
    ASSERT_EQ(result.volume.view().pixelType(), PixelType::Float32);
    const auto view = result.volume.view().as<float>();
    EXPECT_EQ(view.at(2, 1, 0), 0.25F * 5 + 1);
    EXPECT_EQ(view.at(2, 1, 1), 0.5F * 105 + 1);
}

TEST(DicomRescale, SignedSamplesStaySigned) {
    const TempFolder folder;
    for (int k = 0; k < 2; ++k) {
        DicomSlice slice = stackedSlice(k);
        slice.pixelRepresentation = 1;
        slice.bitsStored = 16;
        slice.pixels = samplesOf<std::int16_t>({-5, -4, -3, -2, -1, 0});
        writeFile(folder / scrambledName(k), slice.bytes());
    }
    const ReadVolume result = readVolume(folder.path());
    ASSERT_EQ(result.volume.view().pixelType(), PixelType::Int16);
    EXPECT_EQ(result.volume.view().as<std::int16_t>().at(0, 0, 1), -5);
}

TEST(DicomRescale, Monochrome1IsNotInverted) {
    const TempFolder folder;
    for (int k = 0; k < 2; ++k) {
        DicomSlice slice = stackedSlice(k);
        slice.photometric = "MONOCHROME1";
        writeFile(folder / scrambledName(k), slice.bytes());
    }
    EXPECT_EQ(readVolume(folder.path()).volume.view().as<std::uint16_t>().at(2, 1, 1), 105);
}

TEST(DicomHeaders, RefusesWhatCantBePlacedOrUnderstood) {
    const auto refused = [](auto change, std::string_view fault) {
        const TempFolder folder;
        for (int k = 0; k < 2; ++k) {
            DicomSlice slice = stackedSlice(k);
            change(slice);
            writeFile(folder / scrambledName(k), slice.bytes());
        }
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find(fault), std::string::npos) << message;
        EXPECT_EQ(message.find("Secret"), std::string::npos) << message;
    };
    refused([](DicomSlice& s) { s.position = ""; }, "ImagePositionPatient");
    refused([](DicomSlice& s) { s.position = "1\\2\\NaN"; }, "ImagePositionPatient");
    refused([](DicomSlice& s) { s.orientation = ""; }, "ImageOrientationPatient");
    refused([](DicomSlice& s) { s.orientation = "1\\0\\0\\1\\0\\0"; }, "not perpendicular");
    refused([](DicomSlice& s) { s.pixelSpacing = ""; }, "PixelSpacing");
    refused([](DicomSlice& s) { s.pixelSpacing = "1"; }, "PixelSpacing");
    refused([](DicomSlice& s) { s.pixelSpacing = "0\\1"; }, "PixelSpacing");
    refused([](DicomSlice& s) { s.pixelSpacing = "-1\\-1"; }, "PixelSpacing of 0 or less");
    refused([](DicomSlice& s) { s.photometric = "RGB"; }, "colour");
    refused([](DicomSlice& s) { s.photometric = "PALETTE COLOR"; }, "colour");
    refused([](DicomSlice& s) { s.rescaleSlope = "0"; }, "RescaleSlope is 0");
    refused([](DicomSlice& s) { s.rescaleSlope = "steep"; }, "RescaleSlope");
    refused([](DicomSlice& s) { s.rows = 0; }, "Rows");
    refused([](DicomSlice& s) { s.bitsAllocated = 12; }, "pixel bits");
    refused([](DicomSlice& s) { s.bitsStored = 17; }, "pixel bits");
    refused([](DicomSlice& s) { s.numberOfFrames = "-1"; }, "NumberOfFrames");
    refused([](DicomSlice& s) { s.numberOfFrames = "3"; }, "truncated");
    refused([](DicomSlice& s) { s.imageType = "ORIGINAL\\PRIMARY\\M\\MOSAIC"; }, "mosaic");
    refused([](DicomSlice& s) { s.pixels.resize(10); }, "hold 10 of 12 bytes");
    refused([](DicomSlice& s) { s.hasPixelData = false; }, "without pixel data");
}

TEST(DicomTruncation, IsRefusedWhereverASliceEnds) {
    const TempFolder folder;
    writeStack(folder, 3);
    const std::string whole = stackedSlice(1).bytes();
    // without slice 1, slices 0 and 2 would make a stack of their own
    for (std::size_t length = 1; length < whole.size(); ++length) {
        writeFile(folder / scrambledName(1), whole.substr(0, length));
        EXPECT_FALSE(refusalOf(folder.path()).empty()) << length;
    }
}

TEST(DicomDamage, DeepNestingAndWrongLengthsAreRefused) {
    const TempFolder folder;
    const std::string whole = stackedSlice(0).bytes();
    const std::size_t pixelData = whole.rfind("OW") - 4;
    std::string nested;
    for (int depth = 0; depth < 100000; ++depth) {
        nested += std::string("\x08\x00\x40\x11SQ\0\0\xff\xff\xff\xff", 12);  // without end
        nested += std::string("\xfe\xff\x00\xe0\xff\xff\xff\xff", 8);
    }
    expectRefusal(writeFile(folder / "deep.dcm",
                            whole.substr(0, pixelData) + nested + whole.substr(pixelData)),
                  "nested too deeply");
    std::string wrong = whole;
    put<std::uint16_t>(wrong, wrong.find("DS") + 2, 0xfffe);
    expectRefusal(writeFile(folder / "wrong.dcm", wrong), "damaged");
}

TEST(DicomFolder, WithoutImagesIsRefused) {
    const TempFolder folder;
    expectRefusal(folder.path(), "no DICOM file found");
    writeFile(folder / "about.txt", "pictures\n");
    writeFile(folder / "slice2.png", "\x89PNG\r\n\x1a\n" + std::string(60, ' '));
    expectRefusal(folder.path(), "file 2 (by name) is a PNG picture; convert pictures to NRRD");
    writeFile(folder / "slice.dcm", "");
    EXPECT_NE(refusalOf(folder.path()).find("a slice would be missing"), std::string::npos);
}

TEST(DicomFolder, LeavesOutReportsAndPlans) {
    const TempFolder folder;
    writeStack(folder, 3);
    DicomSlice report = stackedSlice(0);
    report.sopClass = "1.2.840.10008.5.1.4.1.1.88.22";
    report.hasPixelData = false;
    writeFile(folder / "report.dcm", report.bytes());
    EXPECT_EQ(readVolume(folder.path()).volume.view().geometry().size[2], 3);
}

TEST(DicomFolder, PipesAreLeftOutAndBrokenLinksRefused) {
    const TempFolder folder;
    writeStack(folder, 3);
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const ReadVolume result = readVolume(folder.path());
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_NE(result.warnings[0].text.find("1 entries"), std::string::npos);
    std::filesystem::create_symlink("nowhere", folder / "annexed.dcm");
    EXPECT_NE(refusalOf(folder.path()).find("no existing file"), std::string::npos);
}

class DicomCodecs : public ::testing::TestWithParam<DicomCodec> {};

TEST_P(DicomCodecs, ReadsSeriesWrittenByGdcm) {
    const TempFolder folder;
    constexpr int kSize = 16, kSlices = 3;
    const auto sample = [](int i, int j, int k) {
        return static_cast<std::uint16_t>(7 * i + 50 * j + 900 * k);
    };
    for (int k = 0; k < kSlices; ++k) {
        std::vector<std::uint16_t> samples;
        for (int j = 0; j < kSize; ++j) {
            for (int i = 0; i < kSize; ++i) samples.push_back(sample(i, j, k));
        }
        // coronal: rows run to the left, columns down
        writeWithGdcm(folder / scrambledName(k), samples, kSize, {5, 6.0 + 3 * k, 7}, {1, 0, 0},
                      {0, 0, -1}, GetParam());
    }
    const ReadVolume result = readVolume(folder.path());
    const ImageGeometry& g = result.volume.view().geometry();
    ASSERT_EQ(g.size, (Index3{kSize, kSize, kSlices}));
    expectNear(g.originMm, {5, 6, 7}, 0);
    EXPECT_EQ(g.indexToPhysical.column[0], (Vec3{0.5, 0, 0}));
    EXPECT_EQ(g.indexToPhysical.column[1], (Vec3{0, 0, -0.5}));
    EXPECT_EQ(g.indexToPhysical.column[2], (Vec3{0, 3, 0}));
    const auto view = result.volume.view().as<std::uint16_t>();
    for (int k = 0; k < kSlices; ++k) {
        for (int j = 0; j < kSize; ++j) {
            for (int i = 0; i < kSize; ++i) ASSERT_EQ(view.at(i, j, k), sample(i, j, k));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Lossless, DicomCodecs,
                         ::testing::Values(DicomCodec::ImplicitLittleEndian,
                                           DicomCodec::ExplicitLittleEndian, DicomCodec::Rle,
                                           DicomCodec::JpegLossless, DicomCodec::JpegLsLossless,
                                           DicomCodec::Jpeg2000Lossless));

}  // namespace
}  // namespace adaptiso::testing
