#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "GdcmWriter.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kPixels = kColumns * kRows;

/// Two slices with the same pixels, changed by `change`; the volume's first slice.
using Change = std::function<void(DicomBuilder&)>;
void writeTwo(const TempFolder& folder, const Change& change,
              const char* syntax = kExplicitLittleEndian) {
    for (int k = 0; k < 2; ++k) {
        DicomBuilder image = dicomImage(kColumns, kRows);
        placeDicom(image, {0, 0, 2.0 * k});
        change(image);
        writeFile(folder / std::to_string(k), image.file(syntax));
    }
}

template <class T>
std::vector<T> firstSlice(const ReadVolume& read) {
    std::vector<T> samples = samplesIn<T>(read.volume);
    samples.resize(kPixels);
    return samples;
}

void storeBits(DicomBuilder& image, int stored, int highBit, bool isSigned) {
    image.us(0x00280101, static_cast<std::uint16_t>(stored))
        .us(0x00280102, static_cast<std::uint16_t>(highBit))
        .us(0x00280103, isSigned ? 1 : 0);
}

/// Twelve values of 12 bits with sign, both ends among them.
const std::vector<std::int16_t> kSigned12 = {-2048, -2047, -1000, -1,   0,  1,
                                             2,     1000,  2046,  2047, -5, 5};

std::vector<std::uint16_t> wordsOf(const std::vector<std::int16_t>& values, int shift,
                                   std::uint16_t keptBits) {
    std::vector<std::uint16_t> words;
    for (const std::int16_t value : values) {
        words.push_back(
            static_cast<std::uint16_t>((static_cast<std::uint16_t>(value) & keptBits) << shift));
    }
    return words;
}

TEST(DicomBits, SignedTwelveBitsAreExtendedHoweverTheUnusedBitsStand) {
    for (const std::uint16_t kept :
         {std::uint16_t{0xFFFF}, std::uint16_t{0x0FFF}}) {  // the sign above, or zeros
        const TempFolder folder;
        writeTwo(folder, [&](DicomBuilder& image) {
            storeBits(image, 12, 11, true);
            image.pixels(wordsOf(kSigned12, 0, kept));
        });
        const ReadVolume read = readVolume(folder.path());
        EXPECT_EQ(firstSlice<std::int16_t>(read), kSigned12);
        EXPECT_TRUE(read.warnings.empty());
    }
}

TEST(DicomBits, AHighBitAboveIsMovedDown) {
    const TempFolder folder;
    writeTwo(folder, [](DicomBuilder& image) {
        storeBits(image, 12, 15, true);
        std::vector<std::uint16_t> words = wordsOf(kSigned12, 4, 0x0FFF);
        for (std::uint16_t& word : words)
            word = static_cast<std::uint16_t>(word | 3);  // below the lowest bit: no part of it
        image.pixels(words);
    });
    EXPECT_EQ(firstSlice<std::int16_t>(readVolume(folder.path())), kSigned12);
}

TEST(DicomBits, AnOverlayAboveIsTakenOff) {
    const TempFolder folder;
    writeTwo(folder, [](DicomBuilder& image) {
        storeBits(image, 12, 11, false);
        image.us(0x60000100, 16).us(0x60000102, 12);
        image.pixels({0x1000, 0x0FFF, 0x1FFF, 7, 0x1007, 0, 0, 0, 0, 0, 0, 0});
    });
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(firstSlice<std::uint16_t>(read),
              (std::vector<std::uint16_t>{0, 0xFFF, 0xFFF, 7, 7, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(read.warnings.empty());
}

TEST(DicomBits, WhatElseIsAboveIsTakenOffWithAWarning) {
    const TempFolder folder;
    writeTwo(folder, [](DicomBuilder& image) {
        storeBits(image, 12, 11, false);
        std::vector<std::uint16_t> words(kPixels, 9);
        words[0] = 0xFFFF;  // d_mr_42x64x5: pixels of 65535 among 12-bit ones
        image.pixels(words);
    });
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(firstSlice<std::uint16_t>(read)[0], 0x0FFF);
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("2 files have bits set above HighBit"), std::string::npos);
}

TEST(DicomBits, EightBitsAreReadInEveryByteOrder) {
    const std::string bytes("\0\1\2\3\4\5\6\7\x7F\x80\xFE\xFF", kPixels);
    for (const char* syntax : {kExplicitLittleEndian, kImplicitLittleEndian, kExplicitBigEndian}) {
        for (const char* vr : {"OB", "OW"}) {
            const TempFolder folder;
            writeTwo(
                folder,
                [&](DicomBuilder& image) {
                    std::string stored = bytes;
                    if (syntax == kExplicitBigEndian && vr == std::string("OW")) {
                        for (std::size_t n = 0; n < stored.size(); n += 2) {
                            std::swap(stored[n], stored[n + 1]);  // words of two pixels
                        }
                    }
                    storeBits(image, 8, 7, false);
                    image.us(0x00280100, 8).bytes(0x7FE00010, vr, stored);
                },
                syntax);
            const auto read = firstSlice<std::uint8_t>(readVolume(folder.path()));
            EXPECT_EQ(std::string(read.begin(), read.end()), bytes) << syntax << vr;
        }
    }
}

TEST(DicomBits, PixelsOfOtherKindsAreNamed) {
    const auto refused = [](const Change& change, std::string_view fault) {
        const TempFolder folder;
        writeTwo(folder, [&](DicomBuilder& image) {
            image.pixels(std::vector<std::uint16_t>(kPixels, 1));
            change(image);
        });
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find(fault), std::string::npos) << message;
    };
    refused([](DicomBuilder& i) { i.us(0x00280100, 1).us(0x00280101, 1); }, "pixel bits: 1");
    refused([](DicomBuilder& i) { i.us(0x00280102, 16); }, "high bit 16");
    refused([](DicomBuilder& i) { storeBits(i, 12, 10, false); }, "high bit 10");
    refused([](DicomBuilder& i) { i.without(0x00280101); }, "BitsStored is missing");
    refused([](DicomBuilder& i) { i.without(0x00280002); }, "SamplesPerPixel is missing");
    refused([](DicomBuilder& i) { i.without(0x7FE00010).bytes(0x7FE00008, "OF", "12345678"); },
            "floating-point");
}

TEST(DicomTransferSyntax, UnsupportedOnesAreNamed) {
    const auto refused = [](const char* uid, std::string_view name) {
        const TempFolder folder;
        writeTwo(
            folder, [](DicomBuilder& image) { image.fragments({"\1\2\3\4"}); }, uid);
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find(name), std::string::npos) << message;
    };
    refused("1.2.840.10008.1.2.4.102", "MPEG or HEVC");
    refused("1.2.840.10008.1.2.4.201", "HTJ2K");
    refused("1.2.840.10008.1.2.4.110", "JPEG XL");
    refused("1.2.840.10008.1.2.4.92", "part 2");
    refused("1.2.840.10008.1.2.8.1", "deflated frames");
    refused("1.2.840.113619.5.2", "not known here");
    refused(kExplicitLittleEndian, "not as its transfer syntax says");
}

TEST(DicomDeflated, IsReadWholeAndRefusedCut) {
    const TempFolder folder;
    for (int k = 0; k < 3; ++k) {
        writeFile(folder / std::to_string(k),
                  fieldSlice(tellTale, {1, 2, 3.0 + k}).file(kDeflatedLittleEndian));
    }
    expectField(readVolume(folder.path()).volume, tellTale);
    const std::string whole = fieldSlice(tellTale, {1, 2, 4}).file(kDeflatedLittleEndian);
    for (std::size_t length = whole.size() - 100; length < whole.size(); length += 9) {
        writeFile(folder / "1", whole.substr(0, length));
        EXPECT_NE(refusalOf(folder.path()).find("inflated"), std::string::npos) << length;
    }
}

/// A MiB of zeros as a deflate block that may stand anywhere in a stream, any number of times.
std::string deflatedMebibyte() {
    std::string zeros(1 << 20, '\0'), block(1 << 16, '\0');
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
    stream.avail_in = static_cast<uInt>(zeros.size());
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    EXPECT_EQ(deflate(&stream, Z_FULL_FLUSH), Z_OK);
    block.resize(block.size() - stream.avail_out);
    deflateEnd(&stream);
    return block;
}

TEST(DicomDeflated, OfMoreThanHalfAGibibyteIsRefused) {
    const TempFolder folder;
    std::string file = dicomImage(kColumns, kRows).file(kDeflatedLittleEndian);
    file.resize(file.find(kDeflatedLittleEndian) + 22);  // the meta group, which ends with that
    const std::string block = deflatedMebibyte();
    for (int n = 0; n < 513; ++n) file += block;
    expectRefusal(writeFile(folder / "x", file), "inflates to more than 512 MiB");
}

// ---- compressed pixel data, in fragments

std::vector<std::string> cut(const std::string& stream, int parts) {
    std::vector<std::string> fragments;
    const std::size_t size = (stream.size() / static_cast<std::size_t>(parts) + 1) / 2 * 2;
    for (std::size_t at = 0; at < stream.size(); at += size) {
        fragments.push_back(stream.substr(at, size));
    }
    if (fragments.back().size() % 2) fragments.back() += '\0';
    return fragments;
}

class DicomFragments : public ::testing::TestWithParam<DicomCodec> {
protected:
    static constexpr int kSide = 16, kFrames = 3;

    static Vec3 placeOf(int frame) { return {1, 2, 3.0 + 2 * frame}; }
    static double field(const Vec3& p) { return 500 + 4 * p.x + 60 * p.y + 200 * p.z; }
    static std::string frameStream(int frame) {
        return encodeWithGdcm(sampleSlice(field, kSide, kSide, placeOf(frame)), kSide, kSide, 16,
                              false, GetParam());
    }

    /// A file of three frames, each cut into `parts`.
    static DicomBuilder multiFrame(int parts, bool hasOffsets) {
        std::vector<DicomBuilder> groups;
        std::vector<std::string> fragments;
        std::vector<std::uint32_t> offsets;
        std::uint32_t offset = 0;
        for (int n = 0; n < kFrames; ++n) {
            DicomBuilder position, orientation, measures, group;
            position.text(0x00200032, "DS", dicomText(placeOf(n)));
            orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
            measures.text(0x00280030, "DS", "0.75\\0.5");
            group.sequence(0x00209113, {position})
                .sequence(0x00209116, {orientation})
                .sequence(0x00289110, {measures});
            groups.push_back(group);
            if (hasOffsets) offsets.push_back(offset);
            for (const std::string& fragment : cut(frameStream(n), parts)) {
                fragments.push_back(fragment);
                offset += static_cast<std::uint32_t>(fragment.size()) + 8;  // the item's header
            }
        }
        DicomBuilder image = dicomImage(kSide, kSide);
        image.text(0x00280008, "IS", std::to_string(kFrames))
            .sequence(0x52009230, groups)
            .fragments(fragments, offsets);
        return image;
    }
};

TEST_P(DicomFragments, OneSliceMayBeCutIntoSeveral) {
    for (const int parts : {1, 2, 5}) {
        const TempFolder folder;
        for (int n = 0; n < kFrames; ++n) {
            DicomBuilder image = dicomImage(kSide, kSide);
            placeDicom(image, placeOf(n));
            image.fragments(cut(frameStream(n), parts));
            writeFile(folder / std::to_string(n), image.file(uidOf(GetParam())));
        }
        expectField(readVolume(folder.path()).volume, field);
    }
}

TEST_P(DicomFragments, FramesAreFoundByTheOffsetTable) {
    for (const int parts : {1, 3}) {
        const TempFolder folder;
        const auto file = writeFile(folder / "x", multiFrame(parts, true).file(uidOf(GetParam())));
        expectField(readVolume(file).volume, field);
    }
}

TEST_P(DicomFragments, FramesAreFoundWithoutATable) {
    const TempFolder folder;
    expectField(
        readVolume(writeFile(folder / "x", multiFrame(1, false).file(uidOf(GetParam())))).volume,
        field);
    const auto file = writeFile(folder / "x", multiFrame(3, false).file(uidOf(GetParam())));
    if (GetParam() == DicomCodec::Rle) {
        expectRefusal(file, "3 frames, of which 0 are found");  // RLE data look like anything
    } else {
        expectField(readVolume(file).volume, field);
    }
}

TEST_P(DicomFragments, DamagedStreamsAreRefused) {
    const TempFolder folder;
    const auto refused = [&](const std::string& stream) {
        for (int n = 0; n < 2; ++n) {
            DicomBuilder image = dicomImage(kSide, kSide);
            placeDicom(image, placeOf(n));
            image.fragments({n == 0 ? frameStream(0) : stream});
            writeFile(folder / std::to_string(n), image.file(uidOf(GetParam())));
        }
        EXPECT_FALSE(refusalOf(folder.path()).empty());
    };
    refused(std::string(200, '\xA5'));
    refused(std::string(2, '\0'));
    refused(frameStream(1).substr(0, 40));  // within the codestream's header
}

class DicomCodestreams : public DicomFragments {};  // those that say their size

TEST_P(DicomCodestreams, OfAnotherSizeAreRefused) {
    const TempFolder folder;
    const std::string wider =
        encodeWithGdcm(std::vector<std::uint16_t>(32 * kSide, 7), 32, kSide, 16, false, GetParam());
    for (int n = 0; n < 2; ++n) {
        DicomBuilder image = dicomImage(kSide, kSide);
        placeDicom(image, placeOf(n));
        image.fragments({wider});
        writeFile(folder / std::to_string(n), image.file(uidOf(GetParam())));
    }
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("32 x 16 pixels of 1 components"), std::string::npos) << message;
}

TEST_P(DicomFragments, SignedTwelveBitsComeBack) {
    const TempFolder folder;
    std::vector<std::int16_t> values;
    for (int n = 0; n < kSide * kSide; ++n) {
        values.push_back(kSigned12[static_cast<std::size_t>(n) % kSigned12.size()]);
    }
    // JPEG and JPEG-LS know no sign: they keep the 12 bits alone
    const bool keepsSign =
        GetParam() == DicomCodec::Rle || GetParam() == DicomCodec::Jpeg2000Lossless;
    const std::string stream = encodeWithGdcm(wordsOf(values, 0, keepsSign ? 0xFFFF : 0x0FFF),
                                              kSide, kSide, 12, keepsSign, GetParam());
    for (int n = 0; n < 2; ++n) {
        DicomBuilder image = dicomImage(kSide, kSide);
        placeDicom(image, placeOf(n));
        storeBits(image, 12, 11, true);
        image.fragments({stream});
        writeFile(folder / std::to_string(n), image.file(uidOf(GetParam())));
    }
    auto read = samplesIn<std::int16_t>(readVolume(folder.path()).volume);
    read.resize(values.size());
    EXPECT_EQ(read, values);
}

INSTANTIATE_TEST_SUITE_P(Compressed, DicomFragments,
                         ::testing::Values(DicomCodec::Rle, DicomCodec::JpegLossless,
                                           DicomCodec::JpegLsLossless,
                                           DicomCodec::Jpeg2000Lossless));

INSTANTIATE_TEST_SUITE_P(Compressed, DicomCodestreams,
                         ::testing::Values(DicomCodec::JpegLossless, DicomCodec::JpegLsLossless,
                                           DicomCodec::Jpeg2000Lossless));

TEST(DicomRle, SegmentsThatReachOutOfTheFragmentAreRefused) {
    const std::string good = encodeWithGdcm(std::vector<std::uint16_t>(kPixels, 300), kColumns,
                                            kRows, 16, false, DicomCodec::Rle);
    const auto refused = [](const std::string& stream) {
        const TempFolder folder;
        writeTwo(
            folder, [&](DicomBuilder& image) { image.fragments({stream}); }, kRleLossless);
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find("RLE segments are damaged"), std::string::npos) << message;
    };
    const auto changed = [&](std::size_t at, std::uint32_t value) {
        std::string bytes = good;
        put(bytes, at, value);
        return bytes;
    };
    refused(changed(0, 255));         // segments
    refused(changed(0, 1));           // too few for 16 bits
    refused(changed(4, 0));           // the first begins within the header
    refused(changed(8, 0xFFFFFFF0));  // the second beyond the end
    refused(changed(8, 64));          // the first is empty
    std::string runsOver = good;      // a run longer than the image
    put(runsOver, 64, std::uint8_t{129});
    refused(runsOver);
}

/// Most memory that this process has had, kB.
long peakKilobytes() {
    rusage usage{};
    EXPECT_EQ(getrusage(RUSAGE_SELF, &usage), 0);
    return usage.ru_maxrss;
}

TEST(DicomRle, ALargerImageThanItsRunsCanGiveTakesNoMemory) {
    const TempFolder folder;
    writeTwo(
        folder,
        [&](DicomBuilder& image) {
            image.us(0x00280010, 65535).us(0x00280011, 65535);  // 8.6 GB a slice
            image.fragments({encodeWithGdcm(std::vector<std::uint16_t>(kPixels, 300), kColumns,
                                            kRows, 16, false, DicomCodec::Rle)});
        },
        kRleLossless);
    const long before = peakKilobytes();
    EXPECT_NE(refusalOf(folder.path()).find("RLE"), std::string::npos);
    EXPECT_LE(peakKilobytes() - before, 100'000);  // the files have 2 kB
}

}  // namespace
}  // namespace adaptiso::testing
