// Files that hold something else than their header says, in every format but DICOM: what could give
// wrong values or a wrong place is refused by name, what is harmless is read with a warning.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

namespace fs = std::filesystem;

// 16 x 8 x 4 samples of 16 bits: a slice has 256 bytes, a volume 1024
constexpr int kSizeX = 16, kSizeY = 8, kSizeZ = 4;
constexpr std::size_t kSliceBytes = 2 * kSizeX * kSizeY, kVolumeBytes = kSliceBytes * kSizeZ;
constexpr const char* kBehind = "behind the image that its header describes";

const std::vector<std::int16_t>& samples() {
    static const auto all = countingSamples<std::int16_t>(kSizeX * kSizeY * kSizeZ);
    return all;
}
std::string data(std::endian order = std::endian::little) {
    return samplesOf(samples(), order);
}

std::string niftiHeader(const std::function<void(NiftiFile&)>& change = {}) {
    NiftiFile file;
    file.dim = {3, kSizeX, kSizeY, kSizeZ, 1, 1, 1, 1};
    file.sformCode = 1;
    file.sform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (change) change(file);
    return file.header();
}

std::string nrrdHeader(const std::string& fields, const std::string& type = "short") {
    return "NRRD0004\ntype: " + type +
           "\ndimension: 3\nspace: LPS\nsizes: 16 8 4\nspace directions: (1,0,0) (0,1,0) "
           "(0,0,1)\nspace origin: (0,0,0)\nendian: little\n" +
           fields + "\n";
}
const std::string kRawNrrd = nrrdHeader("encoding: raw\n");

std::string metaHeader(const std::string& fields = "", const std::string& dataFile = "LOCAL",
                       const std::string& type = "MET_SHORT") {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 1\n"
           "DimSize = 16 8 4\n" +
           fields + "ElementType = " + type + "\nElementDataFile = " + dataFile + "\n";
}

std::string mghHeader() {
    std::string h(284, '\0');
    const std::int32_t numbers[] = {1, kSizeX, kSizeY, kSizeZ, 1, 4};
    for (std::size_t i = 0; i < 6; ++i) put(h, 4 * i, numbers[i], std::endian::big);
    put<std::int16_t>(h, 28, 1, std::endian::big);
    const float geometry[] = {1, 1, 1, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
    for (std::size_t i = 0; i < 15; ++i) put(h, 30 + 4 * i, geometry[i], std::endian::big);
    return h;
}

/// One format's whole file, with `extra` behind its samples.
struct Format {
    const char* name;
    std::function<std::string(const std::string& extra)> file;
};

const std::vector<Format>& formats() {
    using Text = const std::string&;
    static const std::vector<Format> all = {
        {"x.nii", [](Text extra) { return niftiHeader() + data() + extra; }},
        {"x.nii.gz", [](Text extra) { return gzipped(niftiHeader() + data() + extra); }},
        {"raw.nrrd", [](Text extra) { return kRawNrrd + data() + extra; }},
        {"gzip.nrrd",
         [](Text extra) { return nrrdHeader("encoding: gzip\n") + gzipped(data() + extra); }},
        {"x.mha", [](Text extra) { return metaHeader() + data() + extra; }},
        {"packed.mha",
         [](Text extra) {
             return metaHeader("CompressedData = True\n") + zlibbed(data() + extra);
         }},
        {"x.mgh", [](Text extra) { return mghHeader() + data(std::endian::big) + extra; }},
        {"x.mgz",
         [](Text extra) { return gzipped(mghHeader() + data(std::endian::big) + extra); }}};
    return all;
}

bool mentions(const ReadVolume& read, std::string_view text) {
    return std::ranges::any_of(linesOf(read.warnings), [&](const std::string& line) {
        return line.find(text) != std::string::npos;
    });
}

void expectRead(const fs::path& file, std::string_view warning = "") {
    const ReadVolume read = readVolume(file);
    EXPECT_EQ(samplesIn<std::int16_t>(read.volume), samples()) << file;
    if (warning.empty()) {
        EXPECT_TRUE(read.warnings.empty()) << file << ": " << read.warnings.front().text;
    } else {
        EXPECT_TRUE(mentions(read, warning)) << file << " without '" << warning << "'";
    }
}

TEST(MoreThanTheHeaderSays, AnotherVolumeIsRefusedInEveryFormat) {
    const TempFolder folder;
    for (const Format& format : formats()) {
        expectRead(writeFile(folder / format.name, format.file("")));
        const bool isBig = std::string_view(format.name).find(".mg") != std::string_view::npos;
        const std::string volume = data(isBig ? std::endian::big : std::endian::little);
        const auto file = writeFile(folder / format.name, format.file(volume));
        expectRefusal(file, kBehind);
        expectRefusal(file, "1 more image of that size");
    }
}

TEST(MoreThanTheHeaderSays, MoreSlicesAreRefusedInEveryFormat) {
    const TempFolder folder;
    for (const Format& format : formats()) {
        expectRefusal(writeFile(folder / format.name, format.file(std::string(kSliceBytes, '\7'))),
                      "1 more slice");
        expectRefusal(writeFile(folder / format.name, format.file(std::string(700, '\7'))),
                      "half as much again or more");
    }
}

TEST(MoreThanTheHeaderSays, ARowOrColumnTooFewIsRefusedInEveryFormat) {
    const TempFolder folder;
    constexpr std::size_t kRowBytes = 2 * kSizeX * kSizeZ, kColumnBytes = 2 * kSizeY * kSizeZ;
    const std::string both(2 * (kSizeX + kSizeY + 1) * kSizeZ, '\7');
    for (const Format& format : formats()) {
        const auto refused = [&](const std::string& more, std::string_view fault) {
            expectRefusal(writeFile(folder / format.name, format.file(more)), fault);
        };
        refused(std::string(kRowBytes, '\7'), "1 more row of each slice");
        refused(std::string(kColumnBytes, '\7'), "1 more column of each slice");
        refused(std::string(3 * kColumnBytes, '\7'), "3 more columns of each slice");
        refused(both, "more than a slice, row or column too few leaves over");
    }
}

TEST(MoreThanTheHeaderSays, ABorderOfZerosIsMoreOfTheImageWhereItIsWholeRowsOrColumns) {
    const TempFolder folder;
    constexpr std::size_t kRowBytes = 2 * kSizeX * kSizeZ, kColumnBytes = 2 * kSizeY * kSizeZ;
    for (const Format& format : formats()) {
        const bool isMgh = std::string_view(format.name).find(".mg") != std::string_view::npos;
        for (const std::size_t bytes : {kRowBytes, kColumnBytes}) {
            const std::string zeros(bytes + (isMgh ? 20 : 0), '\0');  // and a footer of zeros
            expectRefusal(writeFile(folder / format.name, format.file(zeros)),
                          bytes == kRowBytes ? "1 more row" : "1 more column");
        }
        if (isMgh) continue;
        expectRead(writeFile(folder / format.name, format.file(std::string(kRowBytes - 2, '\0'))),
                   "126 bytes, all 0, follow");
    }
    // to a whole block of 512 bytes, as tapes and caches are written
    const std::string offset =
        niftiHeader([](NiftiFile& f) { f.dataOffset = 384; }) + std::string(32, '\0');
    expectRead(writeFile(folder / "x.nii", offset + data() + std::string(128, '\0')),
               "128 bytes, all 0, follow");
}

TEST(MoreThanTheHeaderSays, NumbersInTextAreHeldAgainstItToo) {
    const TempFolder folder;
    std::string text;
    for (const std::int16_t value : samples()) text += std::to_string(value) + " ";
    const std::string header = nrrdHeader("encoding: text\n");
    const auto with = [&](int count) {
        std::string more;
        for (int n = 0; n < count; ++n) more += "7 ";
        return writeFile(folder / "x.nrrd", header + text + more);
    };
    expectRead(with(kSizeY * kSizeZ - 1), "31 words follow");
    expectRefusal(with(kSizeY * kSizeZ), "its data hold 544 numbers, its header describes 512");
    expectRefusal(with(kSizeX * kSizeZ + 1), "its data hold 577 numbers");
}

TEST(MoreThanTheHeaderSays, AFewBytesOrPaddingAreReadWithAWarning) {
    const TempFolder folder;
    for (const Format& format : formats()) {
        if (std::string_view(format.name).find(".mg") != std::string_view::npos) continue;
        expectRead(writeFile(folder / format.name, format.file("a note of 22 bytes, me")),
                   "22 bytes follow");
        expectRead(writeFile(folder / format.name, format.file(std::string(kVolumeBytes, '\0'))),
                   "1024 bytes, all 0, follow");
    }
}

TEST(MoreThanTheHeaderSays, ALongerImgOfAPairIsRefused) {
    const TempFolder folder;
    const auto header = writeFile(folder / "x.hdr", niftiHeader([](NiftiFile& f) {
                                                        f.magic = std::string("ni1\0", 4);
                                                        f.dataOffset = 0;
                                                    }).substr(0, 348));
    writeFile(folder / "x.img", data());
    expectRead(header);
    const auto image = writeFile(folder / "x.img", data() + data());
    EXPECT_NE(refusalOf(header).find(kBehind), std::string::npos);
    expectRefusal(image, "1 more image");
}

TEST(MoreThanTheHeaderSays, TwoFilesJoinedIntoOneAreRefused) {
    const TempFolder folder;
    const std::string nifti = niftiHeader() + data();
    expectRefusal(writeFile(folder / "x.nii", nifti + nifti), kBehind);
    expectRefusal(writeFile(folder / "x.nii.gz", gzipped(nifti) + gzipped(nifti)), kBehind);
    expectRefusal(writeFile(folder / "x.mha", metaHeader("CompressedData = True\n") +
                                                  zlibbed(data()) + zlibbed(data())),
                  "more compressed data");
}

TEST(MoreThanTheHeaderSays, ASmallerFileJoinedBehindIsRefused) {
    const TempFolder folder;
    const std::string little =
        niftiHeader([](NiftiFile& f) { f.dim = {3, 2, 2, 2, 1, 1, 1, 1}; }) + std::string(16, '\1');
    std::string mgh = mghHeader();
    for (const std::size_t at : {4U, 8U, 12U}) put(mgh, at, 2, std::endian::big);
    mgh += std::string(16, '\1');
    const std::string gap(48, '\0');
    for (const Format& format : formats()) {
        const auto refused = [&](const std::string& more, std::string_view kind) {
            expectRefusal(writeFile(folder / format.name, format.file(more)), kind);
            expectRefusal(folder / format.name, kBehind);
        };
        const bool isMgh = std::string_view(format.name).find(".mg") != std::string_view::npos;
        refused(mgh, "holds an MGH file");
        refused(gap + mgh, "holds an MGH file");
        if (isMgh) refused(std::string(20, '\x41') + mgh, "holds an MGH file");
        refused(little, isMgh ? "" : "holds a NIfTI file");
        refused(gap + little, isMgh ? "" : "holds a NIfTI file");
    }
    const std::string nifti = niftiHeader() + data();
    expectRefusal(writeFile(folder / "x.nii.gz", gzipped(nifti) + gzipped(little)),
                  "holds a NIfTI file");
    expectRefusal(writeFile(folder / "x.nii.gz", gzipped(nifti) + little), "holds a NIfTI file");
    expectRefusal(writeFile(folder / "x.nii", nifti + gzipped(little)), "holds a gzip file");
}

TEST(MoreThanTheHeaderSays, WhatFollowsCompressedDataIsWarnedOfUnlessItIsZeros) {
    const TempFolder folder;
    const std::string nifti = gzipped(niftiHeader() + data());
    expectRead(writeFile(folder / "x.nii.gz", nifti + std::string(512, '\0')));  // a tape's block
    expectRead(writeFile(folder / "x.nii.gz", nifti + "signed by me"), "no compressed data");
}

std::string niftiExtension(std::int32_t bytes, std::endian order = std::endian::little) {
    std::string extension(static_cast<std::size_t>(bytes), 'e');
    put(extension, 0, bytes, order);
    put<std::int32_t>(extension, 4, 6, order);  // a comment
    return extension;
}

TEST(NiftiExtension, ThatReachesBeyondTheVoxelsBeginIsNotReadAsVoxels) {
    const TempFolder folder;
    const auto file = [&](int offset, bool isFlagged, const std::string& content) {
        std::string header =
            niftiHeader([&](NiftiFile& f) { f.dataOffset = static_cast<float>(offset); });
        header[348] = isFlagged ? '\1' : '\0';
        return writeFile(folder / "x.nii", header + content);
    };
    const auto refused = [&](const fs::path& nifti, int offset) {
        expectRefusal(nifti, "voxels begin at byte " + std::to_string(offset));
        expectRefusal(nifti, "set vox_offset to 432");
    };
    const std::string two = niftiExtension(32) + niftiExtension(48);
    expectRead(file(432, true, two + data()));
    for (const bool isFlagged : {true, false}) {
        refused(file(352, isFlagged, niftiExtension(80) + data()), 352);
        refused(file(384, isFlagged, two + data()), 384);
        refused(file(400, isFlagged, two + data()), 400);
    }
    expectRefusal(file(352, true, niftiExtension(32) + data() + "abc"), "an extension lies");
    expectRead(file(352, true, data()));  // the flag alone is wrong
    expectRead(file(352, false, data() + "abc"), "3 bytes follow");
    expectRead(file(384, true, niftiExtension(1 << 20).substr(0, 32) + data()));
    expectRefusal(
        writeFile(folder / "x.nii.gz", gzipped(niftiHeader() + niftiExtension(64) + data())),
        "set vox_offset to 416");
}

TEST(MoreThanTheHeaderSays, AllVolumesOfA4DFileCount) {
    const TempFolder folder;
    const std::string header =
        niftiHeader([](NiftiFile& f) { f.dim = {4, kSizeX, kSizeY, kSizeZ, 2, 1, 1, 1}; });
    const auto file = folder / "x.nii";
    writeFile(file, header + data() + data());
    for (const std::int64_t index : {0, 1}) {
        EXPECT_TRUE(readVolume(file, {.volumeIndex = index}).warnings.empty());
    }
    writeFile(file, header + data() + data() + data());
    for (const std::int64_t index : {0, 1}) {
        expectRefusal(file, kBehind, {.volumeIndex = index});
    }
}

TEST(MoreThanTheHeaderSays, ALargerDataFileIsFineWhereTheHeaderPointsIntoIt) {
    const TempFolder folder;
    writeFile(folder / "x.raw", data() + data() + data());
    const auto nrrd = [&](const std::string& skip) {
        return writeFile(folder / "x.nhdr",
                         nrrdHeader("encoding: raw\n" + skip + "data file: x.raw\n"));
    };
    const auto meta = [&](const std::string& size) {
        return writeFile(folder / "x.mhd", metaHeader("HeaderSize = " + size + "\n", "x.raw"));
    };
    const std::string second = std::to_string(kVolumeBytes);
    expectRead(nrrd("byte skip: " + second + "\n"), "1024 bytes follow");
    expectRead(meta(second), "1024 bytes follow");
    const auto refused = [](const fs::path& file, std::string_view fault) {
        EXPECT_NE(refusalOf(file).find(fault), std::string::npos) << refusalOf(file);
    };
    refused(nrrd(""), "2 more images of that size");
    refused(nrrd("byte skip: 0\n"), "2 more images of that size");
    refused(meta("0"), "2 more images of that size");
    // the last bytes of a file: what is before may be a header, but no image
    refused(nrrd("byte skip: -1\n"), "before the image");
    refused(meta("-1"), "before the image");
    writeFile(folder / "x.raw", std::string(300, 'h') + data());
    expectRead(nrrd("byte skip: -1\n"));
    expectRead(meta("-1"));
    // nor slices that the header misses
    for (const std::size_t slices : {1, 3}) {
        writeFile(folder / "x.raw", data().substr(0, slices * kSliceBytes) + data());
        const std::string fault = std::to_string(slices * kSliceBytes) +
                                  " bytes before the image that its header describes";
        refused(nrrd("byte skip: -1\n"), fault);
        refused(meta("-1"), fault);
    }
}

TEST(MoreThanTheHeaderSays, NothingLiesBetweenAHeaderAndItsSamplesInOneFile) {
    const TempFolder folder;
    const auto nrrd = [&](const std::string& encoding, const std::string& bytes) {
        return writeFile(folder / "x.nrrd",
                         nrrdHeader("encoding: " + encoding + "\nbyte skip: -1\n") + bytes);
    };
    const auto meta = [&](const std::string& bytes) {
        return writeFile(folder / "x.mha", metaHeader("HeaderSize = -1\n", "LOCAL") + bytes);
    };
    expectRead(nrrd("raw", data()));
    expectRead(nrrd("gzip", gzipped(data())));
    expectRead(meta(data()));
    for (const std::size_t count : {std::size_t{5}, kSliceBytes, kSliceBytes + 5}) {
        const std::string more(count, 'h');
        const std::string fault = std::to_string(count) + " bytes between its header and the image";
        for (const std::string& bytes : {more + data(), data() + more}) {
            expectRefusal(nrrd("raw", bytes), fault);
            expectRefusal(nrrd("gzip", gzipped(bytes)), fault);
            expectRefusal(meta(bytes), fault);
        }
        expectRefusal(nrrd("gzip", gzipped(data()) + gzipped(more)), fault);
    }
}

std::string pairHeader(float dataOffset) {
    return niftiHeader([&](NiftiFile& f) {
               f.magic = std::string("ni1\0", 4);
               f.dataOffset = dataOffset;
           })
        .substr(0, 348);
}

/// Headers over a data file `x.raw` (`x.img`): by a skip of bytes, and -1 where it may count from
/// the end.
struct DetachedHeader {
    const char* headerName;
    const char* dataName;
    bool countsFromEnd;
    std::function<std::string(int skip)> text;
};

const std::vector<DetachedHeader>& detachedHeaders() {
    static const auto nrrd = [](const std::string& encoding, int skip) {
        const std::string line = skip == 0 ? "" : "byte skip: " + std::to_string(skip) + "\n";
        return nrrdHeader("encoding: " + encoding + "\n" + line + "data file: x.raw\n");
    };
    static const std::vector<DetachedHeader> all = {
        {"x.nhdr", "x.raw", true, [](int skip) { return nrrd("raw", skip); }},
        {"gzip.nhdr", "x.raw", true, [](int skip) { return nrrd("gzip", skip); }},
        {"x.mhd", "x.raw", true,
         [](int skip) {
             const std::string line = "HeaderSize = " + std::to_string(skip) + "\n";
             return metaHeader(skip == 0 ? "" : line, "x.raw");
         }},
        {"x.hdr", "x.img", false, [](int skip) { return pairHeader(static_cast<float>(skip)); }}};
    return all;
}

std::string packedFor(const DetachedHeader& header, const std::string& bytes) {
    return std::string_view(header.headerName) == "gzip.nhdr" ? gzipped(bytes) : bytes;
}

/// Expects a refusal in one line that begins with the header's name.
void expectRefusedOver(const DetachedHeader& header, int skip, const std::string& content,
                       std::string_view fault) {
    const TempFolder folder;
    writeFile(folder / header.dataName, content);
    expectRefusal(writeFile(folder / header.headerName, header.text(skip)), fault);
}

struct OtherImage {
    std::string name;
    std::string bytes;  ///< its samples are the last kVolumeBytes
};

std::vector<OtherImage> otherImages() {
    DicomSlice slice;
    slice.columns = kSizeX, slice.rows = kSizeY * kSizeZ, slice.pixels = data();
    return {{"a NIfTI file", niftiHeader() + data()},
            {"an MGH file", mghHeader() + data()},
            {"a NRRD file", kRawNrrd + data()},
            {"a MetaImage file", metaHeader() + data()},
            {"a DICOM file", slice.bytes()}};
}

TEST(OtherImagesAsData, AreReadWhereTheirSamplesBeginOnly) {
    for (const DetachedHeader& header : detachedHeaders()) {
        for (const OtherImage& other : otherImages()) {
            const int at = static_cast<int>(other.bytes.size() - kVolumeBytes);
            const std::string content = packedFor(header, other.bytes);
            for (const int skip : {0, 4, at - 4, at - 1}) {
                expectRefusedOver(header, skip, content, "is " + other.name);
            }
            if (other.name != "a DICOM file") {
                expectRefusedOver(header, 0, content,
                                  "voxels begin at byte " + std::to_string(at) + ", not 0");
            }
            const TempFolder folder;
            writeFile(folder / header.dataName, content);
            const auto behindTheEnd = header.text(at + static_cast<int>(kVolumeBytes) + 5);
            refusalOf(writeFile(folder / header.headerName, behindTheEnd));
            expectRead(writeFile(folder / header.headerName, header.text(at)));
            if (!header.countsFromEnd) continue;
            expectRead(writeFile(folder / header.headerName, header.text(-1)));
            // a byte behind the samples moves what are the last bytes
            expectRefusedOver(header, -1, packedFor(header, other.bytes + "\n"),
                              "is " + other.name);
        }
    }
}

TEST(OtherImagesAsData, LinesMayBeSkippedToTheirSamples) {
    const TempFolder folder;
    const auto header = [&](const std::string& encoding, std::ptrdiff_t lines) {
        return writeFile(folder / "x.nhdr", nrrdHeader("encoding: " + encoding +
                                                       "\nline skip: " + std::to_string(lines) +
                                                       "\ndata file: x.raw\n"));
    };
    const auto lines = std::ranges::count(kRawNrrd, '\n');
    writeFile(folder / "x.raw", kRawNrrd + data());
    expectRead(header("raw", lines));
    EXPECT_NE(refusalOf(header("raw", lines - 1)).find("a NRRD file"), std::string::npos);
    const std::string packed = nrrdHeader("encoding: gzip\n");
    writeFile(folder / "x.raw", packed + gzipped(data()));
    expectRead(header("gzip", lines));
    EXPECT_NE(refusalOf(header("raw", lines)).find("a NRRD file"), std::string::npos);
}

TEST(OtherImagesAsData, AHeaderWithoutSamplesIsNoData) {
    for (const DetachedHeader& header : detachedHeaders()) {
        for (const std::string& text : {pairHeader(0) + data(), metaHeader("", "y.raw") + data(),
                                        nrrdHeader("encoding: raw\ndata file: y.raw\n") + data()}) {
            expectRefusedOver(header, 0, packedFor(header, text), "would be read as voxels");
        }
    }
}

TEST(OtherImagesAsData, AreRefusedBehindATextHeaderToo) {
    const TempFolder folder;
    const std::string nifti = niftiHeader() + data();
    for (const auto& [name, header] : {std::pair{"x.nrrd", kRawNrrd}, {"x.mha", metaHeader()}}) {
        expectRefusal(writeFile(folder / name, header + nifti),
                      "the data behind its header are a NIfTI file");
    }
    expectRefusal(writeFile(folder / "x.nrrd", nrrdHeader("encoding: gzip\n") + gzipped(nifti)),
                  "set byte skip to 352");
}

TEST(OtherKindsOfData, AreNamed) {
    using namespace std::string_literals;
    const std::string pad(3 * kVolumeBytes, '#');
    const std::pair<std::string, const char*> kinds[] = {
        {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 1024\n",
         "git-lfs pointer"},
        {"<!DOCTYPE html><html><body>Log in</body></html>", "a web page"},
        {"\x89PNG\r\n\x1a\n"s, "a PNG picture"},
        {"PK\3\4"s, "a zip archive"},
        {"BZh91AY&SY"s, "bzip2"},
        {""s, "an empty file"}};
    for (const DetachedHeader& header : detachedHeaders()) {
        for (const auto& [bytes, name] : kinds) {
            expectRefusedOver(header, 0, bytes, name);
            if (!bytes.empty()) {
                expectRefusedOver(header, 0, bytes + pad, name);
                expectRefusedOver(header, 0, packedFor(header, bytes + pad), name);
            }
        }
    }
}

TEST(OtherKindsOfData, DicomIsNamedWithoutItsMagicToo) {
    const std::string dicom = otherImages().back().bytes.substr(132);
    for (const DetachedHeader& header : detachedHeaders()) {
        if (packedFor(header, "x") == "x") expectRefusedOver(header, 0, dicom, "is a DICOM file");
    }
}

TEST(OtherKindsOfData, PackedDataWithoutAWordInTheHeaderGetIt) {
    for (const std::size_t index : {0U, 2U}) {
        expectRefusedOver(detachedHeaders()[index], 0, gzipped(data()),
                          index == 0 ? "say so in the header: encoding: gzip"
                                     : "say so in the header: CompressedData = True");
    }
    const TempFolder folder;
    writeFile(folder / "x.raw", data());
    const auto header = writeFile(folder / "x.nhdr", detachedHeaders()[1].text(0));
    EXPECT_NE(refusalOf(header).find("x.raw: its data are not compressed"), std::string::npos);
}

TEST(OtherKindsOfData, AreNoneWhereTheLengthIsRight) {
    const TempFolder folder;
    std::vector<std::int16_t> values = samples();
    values[0] = static_cast<std::int16_t>(0x8b1f);  // gzip's magic
    writeFile(folder / "x.raw", samplesOf(values));
    const auto header = writeFile(folder / "x.nhdr", detachedHeaders()[0].text(0));
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(header).volume), values);
}

TEST(OtherKindsOfData, WhatFollowsADataFileMayBeAHeaderBeforeIt) {
    const TempFolder folder;
    for (const int bytes : {60, 100}) {
        writeFile(folder / "x.raw", std::string(static_cast<std::size_t>(bytes), 'h') + data());
        const auto header = writeFile(folder / "x.nhdr", detachedHeaders()[0].text(0));
        const std::string hint =
            "if they are a header before it, set byte skip to " + std::to_string(bytes);
        if (bytes == 60) {
            EXPECT_TRUE(mentions(readVolume(header), hint));
        } else {  // as many as a column of each slice has, and more
            EXPECT_NE(refusalOf(header).find(hint), std::string::npos) << refusalOf(header);
        }
        expectRead(writeFile(header, detachedHeaders()[0].text(bytes)));
    }
}

/// A CR before every LF, as FTP's text mode does to Windows.
std::string withWindowsLineEnds(const std::string& bytes) {
    std::string turned;
    for (const char c : bytes) turned += c == '\n' ? "\r\n" : std::string(1, c);
    return turned;
}

/// As programs do that take the bytes for Latin-1.
std::string asUtf8(const std::string& bytes) {
    std::string turned;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            turned += c;
        } else {
            turned +=
                {static_cast<char>(0xc0 | byte >> 6), static_cast<char>(0x80 | (byte & 0x3f))};
        }
    }
    return turned;
}

TEST(TextModeTransfer, IsRefusedInEveryFormat) {
    const TempFolder folder;
    const auto expectTurned = [&](const char* name, const std::string& bytes) {
        expectRefusal(writeFile(folder / name, bytes), "a transfer in text mode");
    };
    for (const Format& format : formats()) {
        const std::string file = format.file("");
        const bool isPacked = file.find("\x1f\x8b") != std::string::npos ||
                              std::string_view(format.name) == "packed.mha";
        ASSERT_NE(withWindowsLineEnds(file), file);
        if (!isPacked) expectTurned(format.name, withWindowsLineEnds(file));
    }
    expectTurned("x.nii.gz", gzipped(withWindowsLineEnds(niftiHeader() + data())));
    expectTurned("x.nrrd", nrrdHeader("encoding: gzip\n") + gzipped(withWindowsLineEnds(data())));
    // an image's border of zeros is left over, and MGH's footer follows
    const std::string border = data() + std::string(4 * kVolumeBytes, '\0');
    const auto wide = [](NiftiFile& f) { f.dim = {3, kSizeX, kSizeY, 5 * kSizeZ, 1, 1, 1, 1}; };
    expectTurned("x.nii", withWindowsLineEnds(niftiHeader(wide) + border));
    expectTurned("x.mgh", withWindowsLineEnds(mghHeader() + data(std::endian::big) +
                                              std::string(20, '\x41')));
}

TEST(TextModeTransfer, OfADataFileIsRefused) {
    for (const DetachedHeader& header : detachedHeaders()) {
        const TempFolder folder;
        const auto turned = packedFor(header, withWindowsLineEnds(data()));
        writeFile(folder / header.dataName, turned);
        const auto file = writeFile(folder / header.headerName, header.text(0));
        EXPECT_NE(refusalOf(file).find("a transfer in text mode"), std::string::npos);
        if (!header.countsFromEnd) continue;
        writeFile(file, header.text(-1));
        EXPECT_NE(refusalOf(file).find("a transfer in text mode"), std::string::npos);
    }
}

TEST(TextModeTransfer, ToUtf8IsRefused) {
    const TempFolder folder;
    std::vector<std::int16_t> values = samples();
    for (const std::size_t n : {40U, 80U, 81U, 200U}) values[n] = -100;
    const std::string bytes = samplesOf(values);
    expectRefusal(writeFile(folder / "x.nrrd", kRawNrrd + asUtf8(bytes)), "text mode");
    expectRefusal(writeFile(folder / "x.mha", metaHeader() + asUtf8(bytes)), "text mode");
    writeFile(folder / "x.nrrd", kRawNrrd + bytes + "note");
    EXPECT_TRUE(mentions(readVolume(folder / "x.nrrd"), "4 bytes follow"));
}

TEST(TextModeTransfer, ThatMakesFilesShorterIsRefused) {
    const TempFolder folder;
    std::vector<std::int16_t> values = samples();
    values[50] = 0x0a0d;
    std::string bytes = samplesOf(values);
    bytes.replace(100, 2, "\n");
    expectRefusal(writeFile(folder / "x.nrrd", kRawNrrd + bytes), "truncated");
    EXPECT_NE(refusalOf(folder / "x.nrrd").find("in binary mode"), std::string::npos);
}

TEST(TextModeTransfer, ThatMovesANiftiHeaderIsRefused) {
    const TempFolder folder;
    const std::string header = niftiHeader([](NiftiFile& f) { f.units = 10; });  // mm and s
    expectRead(writeFile(folder / "x.nii", header + data()));
    expectRefusal(writeFile(folder / "x.nii", withWindowsLineEnds(header + data())),
                  "its NIfTI magic is at byte 345, not 344");
}

TEST(TextModeTransfer, OfATextHeaderAloneHarmsNothing) {
    const TempFolder folder;
    expectRead(writeFile(folder / "x.nrrd", withWindowsLineEnds(kRawNrrd) + data()));
    expectRead(writeFile(folder / "x.mha", withWindowsLineEnds(metaHeader()) + data()));
    // a note may have the line ends of Windows
    expectRead(writeFile(folder / "x.mha", metaHeader() + data() + "\r\na note\r\n"),
               "10 bytes follow");
}

std::string mghTag(std::int32_t tag, const std::string& content) {
    return bytesOf(tag, std::endian::big) +
           bytesOf(static_cast<std::int64_t>(content.size()), std::endian::big) + content;
}

/// Tag 1 tells of no length. Version 1 lists names and colours, version 2 labels too.
std::string colorTable(int version) {
    const auto number = [](std::int32_t value) { return bytesOf(value, std::endian::big); };
    const auto text = [&](const std::string& word) {
        return number(static_cast<std::int32_t>(word.size()) + 1) + word + std::string(1, '\0');
    };
    std::string table = number(1);
    table += version == 2 ? number(-2) + number(1000) : number(2);
    table += text("/opt/FreeSurferColorLUT.txt");
    if (version == 2) table += number(2);
    for (const std::int32_t label : {10, 17}) {
        if (version == 2) table += number(label);
        table += text("Left-Thalamus") + number(0) + number(118) + number(14) + number(0);
    }
    return table;
}

TEST(MghFooter, IsNoImage) {
    const TempFolder folder;
    const std::string image = mghHeader() + data(std::endian::big);
    const std::string numbers(20, '\x41');  // TR, flip angle, TE, TI, FoV
    const std::string xform =
        "/home/someone/talairach.xfm\0";  // as much text as an image has bytes
    const std::string commands(2 * kVolumeBytes, 'c');
    for (const std::string& footer :
         {numbers.substr(0, 16), numbers, numbers + mghTag(31, xform),
          numbers + mghTag(3, commands) + mghTag(41, "AXIAL") + mghTag(3, "mri_convert")}) {
        expectRead(writeFile(folder / "x.mgh", image + footer));
        expectRead(writeFile(folder / "x.mgz", gzipped(image + footer)));
    }
    const std::string end = bytesOf(-1, std::endian::big);
    expectRead(writeFile(folder / "x.mgh", image + numbers + mghTag(31, xform) + end));
    for (const std::string& table : {colorTable(1), colorTable(2)}) {
        expectRead(writeFile(folder / "x.mgh", image + numbers + table));
        expectRead(writeFile(folder / "x.mgh", image + numbers + table + mghTag(3, commands)));
        const std::string more = numbers + table + std::string(kSliceBytes, '\0') + "\1";
        expectRefusal(writeFile(folder / "x.mgh", image + more), kBehind);
    }
    for (const std::string& footer : {numbers.substr(0, 7), numbers + mghTag(3, "cut").substr(0, 9),
                                      numbers + mghTag(3, commands).substr(0, 40)}) {
        expectRead(writeFile(folder / "x.mgh", image + footer), "MGH footer) are cut off");
    }
}

TEST(MghFooter, HidesNoSliceThatTheHeaderLeavesOut) {
    const TempFolder folder;
    const std::string image = mghHeader() + data(std::endian::big);
    const std::string footer = std::string(20, '\x41') + mghTag(3, "mri_convert");
    for (const auto value : {std::int16_t{0}, std::int16_t{1}, std::int16_t{2}, std::int16_t{20}}) {
        const std::vector<std::int16_t> slice(kSizeX * kSizeY, value);
        const std::string more = samplesOf(slice, std::endian::big);
        for (const std::size_t bytes : {kSliceBytes, kSliceBytes / 2, kSliceBytes / 4}) {
            const std::string part = more.substr(0, bytes) + footer;
            expectRefusal(writeFile(folder / "x.mgh", image + part), kBehind);
            expectRefusal(writeFile(folder / "x.mgz", gzipped(image + part)), kBehind);
        }
    }
}

TEST(MghFooter, ASecondVolumeIsNotTakenForOne) {
    const TempFolder folder;
    // tags 0, 1, 2, ... could be read from these
    using Value = std::int16_t;
    for (const auto value : {Value{0}, Value{1}, Value{3}, Value{20}, Value{31}}) {
        std::vector<std::int16_t> second(samples().size(), value);
        second[40] = 500;
        expectRefusal(writeFile(folder / "x.mgh", mghHeader() + data(std::endian::big) +
                                                      samplesOf(second, std::endian::big)),
                      "1 more image");
    }
}

TEST(MetaImageContradiction, LongOfEightBytesIsRefusedByName) {
    const TempFolder folder;
    const std::vector<std::int64_t> wide(samples().size(), 100);
    for (const char* type : {"MET_LONG", "MET_ULONG"}) {
        const std::string fault = std::string("its ElementType ") + type + " has 4 bytes";
        expectRefusal(writeFile(folder / "x.mha", metaHeader("", "LOCAL", type) + samplesOf(wide)),
                      fault);
        expectRefusal(
            writeFile(folder / "x.mha", metaHeader("CompressedData = True\n", "LOCAL", type) +
                                            zlibbed(samplesOf(wide))),
            fault);
    }
    const ReadVolume read = readVolume(
        writeFile(folder / "x.mha", metaHeader("", "LOCAL", "MET_LONG_LONG") + samplesOf(wide)));
    EXPECT_EQ(samplesIn<std::int64_t>(read.volume), wide);
}

TEST(MetaImageContradiction, SlopeAndOffsetAreApplied) {
    const TempFolder folder;
    const ReadVolume read = readVolume(
        writeFile(folder / "x.mha", metaHeader("ElementToIntensityFunctionSlope = 0.5\n"
                                               "ElementToIntensityFunctionOffset = -3\n") +
                                        data()));
    const auto values = samplesIn<float>(read.volume);
    for (std::size_t n = 0; n < values.size(); ++n) {
        // 16 bits, halved: exact in float
        ASSERT_EQ(values[n], 0.5F * static_cast<float>(samples()[n]) - 3);
    }
    EXPECT_TRUE(mentions(read, "ElementToIntensityFunction"));
    expectRead(writeFile(folder / "x.mha", metaHeader("ElementToIntensityFunctionSlope = 1\n"
                                                      "ElementToIntensityFunctionOffset = 0\n") +
                                               data()));
    for (const char* slope : {"0", "nan", "inf", "steep", "1 2"}) {
        expectRefusal(
            writeFile(folder / "x.mha",
                      metaHeader(std::string("ElementToIntensityFunctionSlope = ") + slope + "\n") +
                          data()),
            "ElementToIntensityFunctionSlope");
    }
}

TEST(MetaImageContradiction, WithoutOffsetIsReadWithAWarning) {
    const TempFolder folder;
    std::string header = metaHeader();
    header.erase(header.find("Offset"), std::string("Offset = 0 0 0\n").size());
    expectRead(writeFile(folder / "x.mha", header + data()), "no Offset");
}

TEST(MetaImageContradiction, OtherObjectsAreRefusedByName) {
    const TempFolder folder;
    for (const char* type : {"Tube", "Mesh", "Scene", "Landmark"}) {
        std::string header = metaHeader();
        header.replace(header.find("Image"), 5, type);
        expectRefusal(writeFile(folder / "x.mha", header + data()),
                      std::string("its ObjectType is '") + type + "', not Image");
    }
}

TEST(MetaImageContradiction, TwoNamesOfOneThingMustAgree) {
    const TempFolder folder;
    expectRead(writeFile(folder / "x.mha", metaHeader("Position = 0 0 0.0\n") + data()));
    expectRefusal(writeFile(folder / "x.mha", metaHeader("Position = 0 0 9\n") + data()),
                  "Offset and Position differ");
    expectRefusal(
        writeFile(folder / "x.mha", metaHeader("Orientation = 1 0 0 0 -1 0 0 0 1\n") + data()),
        "TransformMatrix and Orientation differ");
    expectRefusal(writeFile(folder / "x.mha", metaHeader("ElementByteOrderMSB = True\n") + data()),
                  "ElementByteOrderMSB differ");
}

ReadVolume readText(const std::string& type, const std::vector<std::string>& words) {
    const TempFolder folder;
    std::string text;
    for (const std::string& word : words) text += word + "\n";
    return readVolume(writeFile(
        folder / "x.nrrd",
        "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n" + text));
}

std::vector<std::string> eight(const std::string& last) {
    return {"0", "1", "2", "3", "4", "5", "6", last};
}

TEST(NrrdText, NumbersBeyondTheirTypeAreRefused) {
    struct Case {
        const char *type, *good, *bad;
    };
    for (const Case& c : {Case{"signed char", "-128", "-129"}, Case{"uchar", "255", "256"},
                          Case{"uchar", "0", "-1"}, Case{"short", "-32768", "32768"},
                          Case{"ushort", "65535", "70000"}, Case{"int", "2147483647", "2147483648"},
                          Case{"uint", "4294967295", "4294967296"}, Case{"uint", "1", "-1"},
                          Case{"int64", "9223372036854775807", "9223372036854775808"},
                          Case{"uint64", "18446744073709551615", "18446744073709551616"},
                          Case{"float", "3.4e38", "3.5e38"}, Case{"double", "1e308", "1e309"},
                          Case{"short", "12.0", "12.5"}, Case{"short", "1.2e3", "1.2e9"},
                          Case{"float", "nan", "none"}, Case{"uchar", "7", "seven"}}) {
        EXPECT_NO_THROW(readText(c.type, eight(c.good))) << c.type << ' ' << c.good;
        try {
            readText(c.type, eight(c.bad));
            ADD_FAILURE() << c.type << ' ' << c.bad << " was read";
        } catch (const FileError& error) {
            const std::string message = error.what();
            EXPECT_NE(message.find("number 8 of its data, '" + std::string(c.bad) + "'"),
                      std::string::npos)
                << message;
        }
    }
    EXPECT_EQ(samplesIn<std::int16_t>(readText("short", eight("1.2e3")).volume)[7], 1200);
    EXPECT_EQ(samplesIn<std::uint64_t>(readText("uint64", eight("18446744073709551615")).volume)[7],
              ~std::uint64_t{0});
    EXPECT_EQ(samplesIn<float>(readText("float", eight("-0.25")).volume)[7], -0.25F);
    const std::string endless = "1." + std::string(500, '0') + "e5";  // cut, it would be 1
    EXPECT_THROW(readText("float", eight(endless)), FileError);
}

TEST(NrrdText, MoreNumbersThanVoxelsAreRefused) {
    std::vector<std::string> words = eight("7");
    words.push_back("8");
    EXPECT_TRUE(mentions(readText("short", words), "1 words follow"));
    for (int n = 9; n < 12; ++n) words.push_back(std::to_string(n));  // one more slice
    try {
        readText("short", words);
        ADD_FAILURE() << "was read";
    } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find("hold 12 numbers, its header describes 8"),
                  std::string::npos)
            << error.what();
    }
}

std::string nifti2(const std::string& lineEnds) {
    std::string h(544, '\0');
    put<std::int32_t>(h, 0, 540);
    h.replace(4, 8, std::string("n+2\0", 4) + lineEnds);
    put<std::int16_t>(h, 12, 4);
    put<std::int16_t>(h, 14, 16);
    const std::int64_t dim[] = {3, kSizeX, kSizeY, kSizeZ, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) put(h, 16 + 8 * i, dim[i]);
    put<std::int64_t>(h, 168, 544);
    put<std::int32_t>(h, 348, 1);
    for (std::size_t i : {0, 5, 10}) put(h, 400 + 8 * i, 1.0);
    return h + data();
}

TEST(NiftiContradiction, Nifti2MangledByTextTransferIsRefusedByName) {
    const TempFolder folder;
    expectRead(writeFile(folder / "x.nii", nifti2("\r\n\x1a\n")));
    expectRead(writeFile(folder / "x.nii", nifti2(std::string(4, '\0'))));  // left out
    for (const char* ends : {"\n\x1a\n\0", "\r\r\n\x1a", "\r\x1a\r\0", "\r\n\r\n"}) {
        expectRefusal(writeFile(folder / "x.nii", nifti2(std::string(ends, 4))), "text mode");
    }
    // "\r\n" to "\n", all through the file
    std::string mangled = nifti2("\r\n\x1a\n");
    mangled.erase(mangled.find("\r\n"), 1);
    expectRefusal(writeFile(folder / "x.nii", mangled), "text mode");
}

TEST(NiftiContradiction, ScalingThatMakesVoxelsInfiniteIsRefused) {
    const TempFolder folder;
    const auto scaled = [&](float slope, float intercept) {
        return writeFile(folder / "x.nii", niftiHeader([&](NiftiFile& f) {
                                               f.slope = slope;
                                               f.intercept = intercept;
                                           }) + data());
    };
    expectRefusal(scaled(1e37F, 0), "its scaling (slope 1e+37, intercept 0) makes");
    expectRefusal(scaled(3e38F, 3e38F), "voxels infinite");
    EXPECT_TRUE(readVolume(scaled(1e33F, 0)).warnings.empty());
    EXPECT_TRUE(mentions(readVolume(scaled(0, 5)), "scl_inter is 5 but scl_slope 0"));
    EXPECT_TRUE(readVolume(scaled(std::numeric_limits<float>::quiet_NaN(), 0)).warnings.empty());
}

TEST(NiftiContradiction, InfiniteVoxelsOfTheFileItselfAreNoFaultOfTheScaling) {
    const TempFolder folder;
    std::vector<float> values(samples().size(), 1);
    values[7] = std::numeric_limits<float>::infinity();
    const auto file = writeFile(folder / "x.nii", niftiHeader([](NiftiFile& f) {
                                                      f.datatype = 16;
                                                      f.bitpix = 32;
                                                      f.slope = 2;
                                                  }) + samplesOf(values));
    EXPECT_TRUE(mentions(readVolume(file), "1 of its voxels hold no finite number"));
}

TEST(NiftiContradiction, VoxelSizesOfPixdimAndSformAreCompared) {
    const TempFolder folder;
    const auto sized = [&](float size) {
        return writeFile(folder / "x.nii", niftiHeader([&](NiftiFile& f) {
                                               f.pixdim = {1, size, 1, 1, 0, 0, 0, 0};
                                           }) + data());
    };
    expectRead(sized(1));
    expectRead(sized(1.005F));
    expectRead(sized(-1));  // nifti1.h: the amount counts
    expectRead(sized(0));   // it does not say
    expectRead(sized(2), "voxels are 2 x 1 x 1 mm by pixdim and 1 x 1 x 1 mm by the sform");
    expectRefusal(sized(1000), "1000 x 1 x 1 mm by pixdim");
    expectRefusal(sized(0.001F), "contradicts itself");
}

}  // namespace
}  // namespace adaptiso::testing
