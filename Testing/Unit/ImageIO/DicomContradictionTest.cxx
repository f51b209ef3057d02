// DICOM whose pixels, slices or values are not what the headers say.
#include <gtest/gtest.h>

#include <algorithm>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "GdcmWriter.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

namespace fs = std::filesystem;

constexpr int kSeriesSlices = 5;

using SliceChange = std::function<void(DicomBuilder&, int slice)>;
const SliceChange kUnchanged;

void writeSeries(const TempFolder& folder, const SliceChange& change,
                 const char* syntax = kExplicitLittleEndian) {
    for (int k = 0; k < kSeriesSlices; ++k) {
        DicomBuilder image = fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
        if (change) change(image, k);
        writeFile(folder / ("s" + std::to_string(k) + ".dcm"), image.file(syntax));
    }
}

std::string faultOf(const SliceChange& change, const char* syntax = kExplicitLittleEndian) {
    const TempFolder folder;
    writeSeries(folder, change, syntax);
    return refusalOf(folder.path());
}

void expectFault(std::string_view fault, const SliceChange& change,
                 const char* syntax = kExplicitLittleEndian) {
    const std::string message = faultOf(change, syntax);
    EXPECT_NE(message.find(fault), std::string::npos) << message << "\nwanted: " << fault;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// Reads the series as the field it is; the warnings.
std::vector<Warning> warningsOf(const SliceChange& change,
                                const char* syntax = kExplicitLittleEndian) {
    const TempFolder folder;
    writeSeries(folder, change, syntax);
    const ReadVolume read = readVolume(folder.path());
    expectField(read.volume, tellTale);
    return read.warnings;
}

std::vector<std::uint16_t> pixelsOf(int k, int rows = kRows) {
    return sampleSlice(tellTale, kColumns, rows, {1, 2, 3.0 + 2 * k});
}

void append(DicomBuilder& image, int k, const std::string& extra) {
    image.bytes(0x7FE00010, "OW", samplesOf(pixelsOf(k)) + extra);
}

// ---- more pixels than the header says

TEST(DicomMorePixels, ThanRowsAndColumnsAreRefused) {
    for (const char* syntax : {kExplicitLittleEndian, kImplicitLittleEndian, kExplicitBigEndian,
                               kDeflatedLittleEndian}) {
        // half of the anatomy: twice the rows are there
        expectFault(
            "its pixel data hold 48 bytes, its header describes 24 (4 x 3 pixels of 16 bits",
            [](DicomBuilder& image, int k) { image.pixels(pixelsOf(k, 2 * kRows)); }, syntax);
        expectFault(
            "hold 32 bytes, its header describes 24",  // one row more
            [](DicomBuilder& image, int k) { image.pixels(pixelsOf(k, kRows + 1)); }, syntax);
    }
    expectFault("hold 48 bytes", [](DicomBuilder& image, int k) {  // in one slice of all
        if (k == 2) image.pixels(pixelsOf(k, 2 * kRows));
    });
}

TEST(DicomMorePixels, ThanTheTypeSaysAreRefused) {
    expectFault("describes 12 (4 x 3 pixels of 8 bits", [](DicomBuilder& image, int) {
        image.us(0x00280100, 8).us(0x00280101, 8).us(0x00280102, 7);
    });
}

TEST(DicomMorePixels, PaddingIsNone) {
    EXPECT_TRUE(warningsOf(kUnchanged).empty());
    const auto padded = warningsOf([](DicomBuilder& image, int k) { append(image, k, "\7\7"); });
    ASSERT_EQ(padded.size(), 1U);
    EXPECT_NE(padded[0].text.find("5 files hold a few bytes more of pixel data"),
              std::string::npos);
    const auto block =
        warningsOf([](DicomBuilder& image, int k) { append(image, k, std::string(2048, '\0')); });
    EXPECT_EQ(block.size(), 1U);
    const auto inflated =
        warningsOf([](DicomBuilder& image, int k) { append(image, k, std::string(2048, '\0')); },
                   kDeflatedLittleEndian);
    EXPECT_EQ(inflated.size(), 1U);
}

TEST(DicomMorePixels, AColumnTooFewIsRefused) {
    const std::size_t column = 2 * kRows, row = 2 * kColumns;
    for (const std::size_t bytes : {column, row, row + column + 2}) {
        expectFault("its pixel data hold", [&](DicomBuilder& image, int k) {
            append(image, k, std::string(bytes, '\7'));
        });
    }
    for (const std::size_t bytes : {column, row}) {  // a border of zeros
        expectFault("its pixel data hold", [&](DicomBuilder& image, int k) {
            append(image, k, std::string(bytes, '\0'));
        });
    }
}

TEST(DicomMorePixels, TheByteThatMakesLengthsEvenIsNone) {
    const TempFolder folder;
    for (int k = 0; k < 2; ++k) {
        DicomBuilder image = dicomImage(3, 3);
        placeDicom(image, {0, 0, 2.0 * k});
        image.us(0x00280100, 8).us(0x00280101, 8).us(0x00280102, 7);
        image.bytes(0x7FE00010, "OW", "123456789!");
        writeFile(folder / std::to_string(k), image.file());
    }
    EXPECT_TRUE(readVolume(folder.path()).warnings.empty());
}

DicomBuilder multiFrame(int groups, int frames, int first = 0) {
    std::vector<DicomBuilder> perFrame;
    std::vector<std::uint16_t> samples;
    for (int n = 0; n < frames; ++n) {
        const Vec3 place{1, 2, 3.0 + 2 * (first + n)};
        DicomBuilder position, orientation, measures, group;
        position.text(0x00200032, "DS", dicomText(place));
        orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
        measures.text(0x00280030, "DS", "0.75\\0.5");
        group.sequence(0x00209113, {position})
            .sequence(0x00209116, {orientation})
            .sequence(0x00289110, {measures});
        if (n < groups) perFrame.push_back(group);
        const auto frame = sampleSlice(tellTale, kColumns, kRows, place);
        samples.insert(samples.end(), frame.begin(), frame.end());
    }
    DicomBuilder image = dicomImage(kColumns, kRows);
    image.text(0x00280008, "IS", std::to_string(groups))
        .sequence(0x52009230, perFrame)
        .pixels(samples);
    return image;
}

TEST(DicomMorePixels, ThanNumberOfFramesAreRefused) {
    const TempFolder folder;
    expectField(readVolume(writeFile(folder / "x", multiFrame(4, 4).file())).volume, tellTale);
    expectRefusal(writeFile(folder / "x", multiFrame(3, 6).file()),
                  "hold 144 bytes, its header describes 72 (4 x 3 pixels of 16 bits, 3 frames)");
    expectRefusal(writeFile(folder / "x", multiFrame(3, 4).file()), "hold 96 bytes");
}

TEST(DicomMorePixels, CompressedFramesBeyondTheHeaderAreRefused) {
    for (const DicomCodec codec : {DicomCodec::Rle, DicomCodec::JpegLossless,
                                   DicomCodec::JpegLsLossless, DicomCodec::Jpeg2000Lossless}) {
        const TempFolder folder;
        for (int k = 0; k < 2; ++k) {
            DicomBuilder image = dicomImage(16, 16);
            placeDicom(image, {1, 2, 3.0 + 2 * k});
            const std::string stream = encodeWithGdcm(
                sampleSlice(tellTale, 16, 16, {1, 2, 3.0 + 2 * k}), 16, 16, 16, false, codec);
            image.fragments({stream, stream});
            writeFile(folder / std::to_string(k), image.file(uidOf(codec)));
        }
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find("hold 2 compressed frames, its header describes 1"),
                  std::string::npos)
            << message;
    }
}

TEST(DicomMorePixels, RleThatGoesOnIsRefused) {
    const auto tall = [](DicomBuilder& image, int k) {
        image.fragments({encodeWithGdcm(pixelsOf(k, 2 * kRows), kColumns, 2 * kRows, 16, false,
                                        DicomCodec::Rle)});
    };
    expectFault("RLE data", tall, kRleLossless);
}

TEST(DicomMorePixels, TwoPixelDataElementsAreRefused) {
    const TempFolder folder;
    const std::string file = multiFrame(4, 4).file();
    const std::size_t bytes = std::size_t{2} * 4 * kColumns * kRows;  // the file's last
    const std::string element = std::string("\xE0\x7F\x10\0OW\0\0", 8) +
                                bytesOf(static_cast<std::uint32_t>(bytes)) +
                                file.substr(file.size() - bytes);
    ASSERT_TRUE(file.ends_with(element));
    expectRefusal(writeFile(folder / "x", file + element), "pixel data twice");
}

TEST(DicomMorePixels, BytesBehindTheDataSetAreLeftOut) {
    const TempFolder folder;
    for (const char* const syntax : {kExplicitLittleEndian, kImplicitLittleEndian}) {
        const std::string file = multiFrame(4, 4).file(syntax);
        const auto codes = [&](const std::string& behind) {
            std::vector<std::string> found;
            const ReadVolume read = readVolume(writeFile(folder / "x", file + behind));
            EXPECT_EQ(read.volume.view().geometry().size[2], 4);
            for (const Warning& warning : read.warnings) found.push_back(warning.code);
            return found;
        };
        EXPECT_EQ(codes(""), std::vector<std::string>{});
        EXPECT_EQ(codes(std::string(200, '\0')), std::vector<std::string>{});
        // what the samples of other slices look like
        const std::string samples = file.substr(file.size() - 200);
        EXPECT_EQ(codes(samples), std::vector<std::string>{"trailing-bytes"});
        EXPECT_EQ(codes("abc"), std::vector<std::string>{"trailing-bytes"});
        // elements that may follow pixel data: padding, a private group
        EXPECT_EQ(codes(syntax == std::string(kExplicitLittleEndian)
                            ? std::string("\xFC\xFF\xFC\xFFOB\0\0\4\0\0\0abcd", 16)
                            : std::string("\xFC\xFF\xFC\xFF\4\0\0\0abcd", 12)),
                  std::vector<std::string>{});
        expectRefusal(writeFile(folder / "x", file + file), "another DICOM file");
    }
}

// ---- slices of one series that mean different things

TEST(DicomAgreement, Monochrome1And2InOneSeriesAreRefused) {
    expectFault("MONOCHROME1 (1 slice) and MONOCHROME2 (4 slices)", [](DicomBuilder& image, int k) {
        if (k == 3) image.text(0x00280004, "CS", "MONOCHROME1");
    });
    EXPECT_TRUE(warningsOf([](DicomBuilder& image, int) {
                    image.text(0x00280004, "CS", "MONOCHROME1");
                }).empty());
}

void rescale(DicomBuilder& image, const char* slope, const char* intercept, const char* type = "") {
    image.text(0x00281052, "DS", intercept).text(0x00281053, "DS", slope);
    image.text(0x00281054, "LO", type);
}

TEST(DicomAgreement, SeveralUnitsAreRefused) {
    expectFault("HU (4 slices) and US (1 slice)",
                [](DicomBuilder& image, int k) { rescale(image, "1", "0", k == 0 ? "US" : "HU"); });
    expectFault("BQML (4 slices) and CNTS (1 slice)", [](DicomBuilder& image, int k) {
        image.text(0x00541001, "CS", k == 4 ? "CNTS" : "BQML");
    });
    EXPECT_TRUE(
        warningsOf([](DicomBuilder& image, int) { rescale(image, "1", "0", "HU"); }).empty());
}

TEST(DicomAgreement, SlicesWithoutTheOthersRescaleAreRefused) {
    expectFault("1 of its 5 slices have no RescaleSlope and RescaleIntercept",
                [](DicomBuilder& image, int k) {
                    if (k != 2) rescale(image, "1", "-1024");
                });
    EXPECT_TRUE(warningsOf([](DicomBuilder& image, int k) {
                    if (k != 2) rescale(image, "1", "0");  // what absence means
                }).empty());
}

TEST(DicomAgreement, SignedAndUnsignedSlicesAreReadAsTheySayWithAWarning) {
    const auto warnings = warningsOf([](DicomBuilder& image, int k) {
        if (k == 1) image.us(0x00280103, 1);
    });
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].text.find("signed samples and some unsigned"), std::string::npos);
}

TEST(DicomAgreement, ARescaleThatMakesValuesInfiniteIsRefused) {
    const auto by = [](const char* slope, const char* intercept) {
        return [=](DicomBuilder& image, int) { rescale(image, slope, intercept); };
    };
    expectFault("RescaleSlope 1e+36 and RescaleIntercept 0 make values infinite", by("1e36", "0"));
    expectFault("make values infinite", by("1", "1e300"));
    expectFault("make values infinite", by("1e308", "0"));
}

// ---- fewer images than headers count

/// The one warning of 5 slices whose header says so.
std::string countWarning(const SliceChange& change) {
    const auto warnings = warningsOf(change);
    EXPECT_LE(warnings.size(), 1U);
    return warnings.empty() ? "" : warnings[0].text;
}

TEST(DicomCounts, OfSlicesImagesAndTimePointsAreCompared) {
    const auto slices = [](std::uint16_t count) {
        return countWarning([=](DicomBuilder& image, int) { image.us(0x00540081, count); });
    };
    EXPECT_EQ(slices(7), "its headers count 7 slices (NumberOfSlices), 5 are here: 2 missing");
    EXPECT_EQ(slices(5), "");
    const auto text = [](std::uint32_t tag, const char* count) {
        return countWarning([=](DicomBuilder& image, int) { image.text(tag, "IS", count); });
    };
    EXPECT_EQ(text(0x00201002, "6"),
              "its headers count 6 images (ImagesInAcquisition), 5 are here: 1 missing");
    EXPECT_EQ(text(0x00201002, "5"), "");
    EXPECT_EQ(text(0x00201002, "4"), "");
    EXPECT_EQ(text(0x00200105, "3"),
              "its headers count 3 time points (NumberOfTemporalPositions), 1 is here: 2 missing");
    EXPECT_EQ(text(0x00200105, "1"), "");
}

TEST(DicomCounts, OfAnAcquisitionMayBeThoseOfSeveral) {
    const auto acquisitions = [](int first, const char* stated) {
        return countWarning([=](DicomBuilder& image, int k) {
            image.text(0x00200012, "IS", k < first ? "1" : "2").text(0x00201002, "IS", stated);
        });
    };
    EXPECT_EQ(acquisitions(3, "5"), "");  // of the series
    EXPECT_EQ(acquisitions(3, "3"),
              "its headers count 3 images (ImagesInAcquisition), 2 are here: 1 missing");
    EXPECT_EQ(acquisitions(3, "8"),
              "its headers count 8 images (ImagesInAcquisition), 5 are here: 3 missing");
    // another series of the same acquisition, in the same folder
    const TempFolder folder;
    const auto state = [](DicomBuilder& image, int) { image.text(0x00201002, "IS", "10"); };
    writeSeries(folder, state);
    for (int k = 0; k < kSeriesSlices; ++k) {
        DicomBuilder image = fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
        state(image, k);
        writeFile(folder / ("t" + std::to_string(k)), image.text(0x0020000E, "UI", "1.2.5").file());
    }
    EXPECT_TRUE(readVolume(folder.path(), {.series = "2"}).warnings.empty());
}

TEST(DicomCounts, ConcatenationsMustBeWhole) {
    const TempFolder folder;
    for (int part = 0; part < 3; ++part) {
        DicomBuilder image = multiFrame(2, 2, 2 * part);
        image.text(0x00209161, "UI", "1.2.6")
            .us(0x00209162, static_cast<std::uint16_t>(part + 1))
            .us(0x00209163, 3);
        writeFile(folder / std::to_string(part), image.file());
    }
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(read.volume.view().geometry().size[2], 6);
    expectField(read.volume, tellTale);
    expectRefusal(folder / "0", "holds 1 of the 3 files of a multi-frame image");
    fs::remove(folder / "2");
    expectRefusal(folder.path(), "holds 2 of the 3 files of a multi-frame image");
}

// ---- slices that are there only compressed as a whole

TEST(DicomCompressedSlice, ThatIsThereAloneIsRefused) {
    for (const char* name :
         {"s4.dcm.gz", "s4.IMA.gz", "s4.dcm.bz2", "s4.dcm.xz", "s4.dcm.zst", "s4.gz", "anything"}) {
        const TempFolder folder;
        writeSeries(folder, kUnchanged);
        const std::string ending = fs::path(name).extension();
        const bool isGzip = ending == ".gz" || ending.empty();
        const std::string slice = fieldSlice(tellTale, {1, 2, 11}).file();
        fs::remove(folder / "s4.dcm");  // the last one: no gap tells of it
        writeFile(folder / name, isGzip ? gzipped(slice) : "no gzip");
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find("is a compressed DICOM file: a slice would be missing"),
                  std::string::npos)
            << name << ": " << message;
        EXPECT_EQ(listSeries(folder.path()).damaged.size(), 1U);
    }
}

TEST(DicomCompressedSlice, ACopyBesideItsSliceIsLeftOutWithAWarning) {
    const TempFolder folder;
    writeSeries(folder, kUnchanged);
    writeFile(folder / "s1.dcm.gz", gzipped(fieldSlice(tellTale, {1, 2, 5}).file()));
    const ReadVolume read = readVolume(folder.path());
    expectField(read.volume, tellTale);
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("left out 1 compressed file"), std::string::npos);
}

TEST(DicomCompressedSlice, OtherCompressedFilesAreNone) {
    const TempFolder folder;
    writeSeries(folder, kUnchanged);
    writeFile(folder / "notes.txt.gz", gzipped("nothing of importance"));
    writeFile(folder / "image.nii.gz", gzipped(NiftiFile().bytes()));
    writeFile(folder / "broken.gz", gzipped(std::string(1000, 'b')).substr(0, 14));
    writeFile(folder / "._s1.dcm.gz", "what macOS leaves");
    EXPECT_TRUE(readVolume(folder.path()).warnings.empty());
}

TEST(DicomCompressedSlice, AsTheInputItselfIsRefusedByName) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.dcm.gz", gzipped(multiFrame(4, 4).file())),
                  "compressed as a whole");
}

}  // namespace
}  // namespace adaptiso::testing
