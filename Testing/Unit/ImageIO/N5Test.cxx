#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "ZarrFolder.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ImageRegions.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace testing;

using Pack = std::function<Text(const Text&)>;

Text be16(int value) {
    return bytesOf(static_cast<std::uint16_t>(value), std::endian::big);
}
Text be32(int value) {
    return bytesOf(static_cast<std::uint32_t>(value), std::endian::big);
}

/// Mode 0, three sides, x first.
Text headerOf(int x, int y, int z) {
    return be16(0) + be16(3) + be32(x) + be32(y) + be32(z);
}

/// The samples of a block, cut off at the image's end.
Text blockAt(int cx, int cy, int cz, const Pack& pack) {
    const int x = std::min(kChunk, kX - cx * kChunk), y = std::min(kChunk, kY - cy * kChunk),
              z = std::min(kChunk, kZ - cz * kChunk);
    Text samples;
    for (int k = 0; k < z; ++k) {
        for (int j = 0; j < y; ++j) {
            for (int i = 0; i < x; ++i) {
                samples += bytesOf(valueAt(cx * kChunk + i, cy * kChunk + j, cz * kChunk + k),
                                   std::endian::big);
            }
        }
    }
    return headerOf(x, y, z) + pack(samples);
}

/// As lz4-java writes it: the second half raw, then a block of nothing.
Text lz4Stream(const Text& text) {
    const auto block = [](char method, const Text& packed, std::size_t size) {
        return "LZ4Block" + Text(1, method) + bytesOf(static_cast<std::uint32_t>(packed.size())) +
               bytesOf(static_cast<std::uint32_t>(size)) + "sum?" + packed;
    };
    const Text first = text.substr(0, text.size() / 2), rest = text.substr(text.size() / 2);
    return block(0x26, lz4BlockOf(first), first.size()) + block(0x16, rest, rest.size()) +
           block(0x16, "", 0);
}

class N5Test : public ZarrFolder {
protected:
    static Text metadata(const std::string& compression, const std::string& more = "") {
        return withLastOfKeys(
            R"({"dimensions": [7, 6, 5], "blockSize": [4, 4, 4], "dataType": "int16",
                   "compression": )" +
            compression + more + "}");
    }
    void putBlocks(const std::string& prefix, const Pack& pack) const {
        for (int z = 0; z < kChunksZ; ++z) {
            for (int y = 0; y < kChunksY; ++y) {
                for (int x = 0; x < kChunksX; ++x) {
                    put(prefix + std::to_string(x) + "/" + std::to_string(y) + "/" +
                            std::to_string(z),
                        blockAt(x, y, z, pack));
                }
            }
        }
    }
    void putArray(const std::string& path, const std::string& more = "") const {
        put(path + "attributes.json", metadata(R"({"type": "raw"})", more));
        putBlocks(path, same);
    }
    Vec3 originOf(const ReadOptions& options) const {
        return readVolume(root_, options).volume.view().geometry().originMm;
    }
};

TEST_F(N5Test, IsReadInEveryCodec) {
    const std::pair<std::string, Pack> codecs[] = {
        {R"({"type": "raw"})", same},
        {R"({"type": "gzip", "useZlib": false, "level": -1})", gzipped},
        {R"({"type": "gzip", "useZlib": true})", zlibbed},
        {R"({"type": "zstd", "level": 3})", zstdOf},
        {R"({"type": "lz4", "blockSize": 65536})", lz4Stream},
        {R"({"type": "blosc", "cname": "lz4"})",
         [](const Text& t) { return bloscOf(t, "blosclz"); }}};
    for (const auto& [metadataOf, pack] : codecs) {
        SCOPED_TRACE(metadataOf);
        fs::remove_all(root_);
        put("attributes.json", metadata(metadataOf));
        putBlocks("", pack);
        const ReadVolume read = readVolume(root_);
        expectValues(read);
        EXPECT_EQ(read.format, "N5");
    }
}

TEST_F(N5Test, BlocksBeyondTheDimensionsAreMoreOfTheImage) {
    putArray("");
    for (const char* const key : {"2/0/0", "0/2/0", "0/0/2"}) {
        put(key, blockAt(0, 0, 0, same));
        expectRefused(std::string("beyond the shape that its metadata state (5 x 6 x 7): ") + key);
        fs::remove(root_ / key);
        expectValues(readVolume(root_));
    }
    // fewer planes along x, which is named first
    Text fewer = metadata(R"({"type": "raw"})");
    fewer.replace(fewer.find("[7"), 2, "[4");
    put("attributes.json", fewer);
    expectRefused("holds chunks beyond the shape");
}

TEST_F(N5Test, BlocksOfAnotherSizeThanTheDimensionsSayAreRefused) {
    const std::pair<const char*, const char*> others[] = {
        {"[7", "[6"}, {"[7", "[8"}, {"6, ", "5, "}, {"6, ", "7, "}};
    for (const auto& [from, to] : others) {
        for (const auto& [type, pack] : {std::pair{"raw", Pack(same)}, {"gzip", Pack(gzipped)}}) {
            SCOPED_TRACE(std::string(to) + type);
            Text text = metadata(R"({"type": ")" + Text(type) + "\"}");
            text.replace(text.find(from), std::string(from).size(), to);
            put("attributes.json", text);
            putBlocks("", pack);
            expectRefused("its header and the metadata do not agree on the block's size");
        }
    }
}

TEST_F(N5Test, BeforeVersion2CompressionWasAName) {
    put("attributes.json", R"({"dimensions": [7, 6, 5], "blockSize": [4, 4, 4],
                               "dataType": "int16", "compressionType": "gzip"})");
    putBlocks("", gzipped);
    expectValues(readVolume(root_));
}

TEST_F(N5Test, BlocksMayBeWholeAtTheEndAndMissingOnesAreZero) {
    putArray("");
    put("1/1/1", headerOf(4, 4, 4) + chunkAt(1, 1, 1, false, true));
    expectValues(readVolume(root_));
    fs::remove(root_ / "1/1/1");
    const ReadVolume read = readVolume(root_);
    EXPECT_EQ(read.volume.view().as<std::int16_t>().at(5, 5, 4), 0);
    EXPECT_EQ(read.volume.view().as<std::int16_t>().at(3, 5, 4), valueAt(3, 5, 4));
    EXPECT_NE(read.warnings.back().text.find("1 of its 8 chunks are not there"), std::string::npos);
    EXPECT_EQ(ImageRegions::open(root_, {}).constantIn({4, 4, 4}, {2, 2, 1}), 0);
}

/// A voxel of s1 is 2 x 2 x 1 of s0, of .5 x .25 x 2 um: its middle lies .5 x .5 x 0 of them in.
TEST_F(N5Test, AGroupHasLevelsAsN5ViewerAndNeuroglancerWriteThem) {
    const std::string pixel = R"("pixelResolution": {"unit": "um", "dimensions": [0.5, 0.25, 2]})";
    const std::string lists = R"([[1, 1, 1], [2, 2, 1]])";
    const std::array<std::pair<std::string, std::string>, 5> ways{
        {{"{" + pixel + "}", R"(, "downsamplingFactors": [2, 2, 1])"},
         {R"({"n5": "2.5.0", "downsamplingFactors": )" + lists + "}", ", " + pixel},
         {R"({"pixelResolution": [0.5, 0.25, 2], "scales": )" + lists + "}", ""},
         {R"({"axes": ["x", "y", "z"], "units": ["nm", "nm", "nm"], "scales": )" + lists +
              R"(, "resolution": [500, 250, 2000]})",
          ""},
         {R"({"resolution": [500, 250, 2000], "units": ["nm", "nm", "nm"]})",
          R"(, "downsamplingFactors": [2, 2, 1])"}}};
    ReadOptions coarse;
    coarse.level = 1;
    for (const auto& [group, level] : ways) {
        SCOPED_TRACE(group + level);
        fs::remove_all(root_);
        put("attributes.json", group);
        putArray("s0/", level.find("pixel") != level.npos ? level : "");
        putArray("s1/", level);
        const ReadVolume fine = readVolume(root_), read = readVolume(root_, coarse);
        expectValues(fine);
        expectValues(read, coarse);
        const Vec3 spacing = fine.volume.view().geometry().spacingMm();
        EXPECT_NEAR(norm(spacing - Vec3{0.5e-3, 0.25e-3, 2e-3}), 0, 1e-15);
        const Vec3 twice = read.volume.view().geometry().spacingMm();
        EXPECT_NEAR(norm(twice - Vec3{1e-3, 0.5e-3, 2e-3}), 0, 1e-15);
        EXPECT_EQ(originOf({}), (Vec3{0, 0, 0}));
        EXPECT_NEAR(norm(originOf(coarse) - Vec3{0.25e-3, 0.125e-3, 0}), 0, 1e-15);
    }
    coarse.level = 2;
    expectRefused("there is no level 2: it holds 2; choose one, 0 to 1 (--level)", coarse);
}

TEST_F(N5Test, AxesMayBeNamedAndChannelsChosen) {
    put("attributes.json", R"({"dimensions": [7, 2, 6, 5], "blockSize": [4, 1, 4, 4],
        "dataType": "int16", "compression": {"type": "raw"}, "axes": ["x", "c", "y", "z"]})");
    for (int n = 0; n < 8; ++n) {
        const int x = n & 1, y = n >> 1 & 1, z = n >> 2;
        const Text block = blockAt(x, y, z, same);
        put(std::to_string(x) + "/1/" + std::to_string(y) + "/" + std::to_string(z),
            be16(0) + be16(4) + block.substr(4, 4) + be32(1) + block.substr(8));
    }
    ReadOptions options;
    options.channel = 1;
    expectValues(readVolume(root_, options), options);
    expectRefused("holds 2 channels; choose one, 0 to 1 (--channel)");
}

TEST_F(N5Test, UnitsOfPixelsAreNone) {
    putArray("", R"(, "pixelResolution": {"unit": "pixel", "dimensions": [1, 1, 2]})");
    const ReadVolume read = readVolume(root_);
    EXPECT_EQ(read.volume.view().geometry().spacingMm()[2], 2);
    EXPECT_NE(read.warnings.front().text.find("have no unit"), std::string::npos);
}

TEST_F(N5Test, ResolutionsThatAreNotSaidAreGuessedWithAWarning) {
    putArray("", R"(, "axes": ["x", "y", "z"], "units": ["nm", "nm", "nm"])");
    EXPECT_EQ(readVolume(root_).warnings.front().code, "guessed-spacing");
    putArray("", R"(, "resolution": [1, 1, 1], "units": [" ", "", "px"])");
    EXPECT_EQ(readVolume(root_).warnings.front().code, "guessed-unit");
}

TEST_F(N5Test, DamagedBlocksAreRefused) {
    putArray("");
    const std::pair<Text, std::string> wrong[] = {
        {"", "is empty"},
        {headerOf(4, 4, 4).substr(0, 9), "too short for the header"},
        {be16(1) + blockAt(0, 0, 0, same).substr(2), "block of mode 1"},
        {be16(0) + be16(2) + be32(4) + be32(4) + Text(32, 'x'), "do not agree on the block's size"},
        {be16(0) + be16(65535) + Text(70, 'x'), "do not agree on the block's size"},
        {headerOf(3, 4, 4) + Text(96, 'x'), "do not agree on the block's size"},
        {headerOf(4, 4, 5) + Text(160, 'x'), "do not agree on the block's size"},
        {headerOf(-1, -1, -1) + Text(160, 'x'), "do not agree on the block's size"},
        {blockAt(0, 0, 0, same) + "x", "holds 129 bytes of a chunk of 128"},
        {blockAt(0, 0, 0, same).substr(0, 100), "holds 84 bytes of a chunk of 128"}};
    for (const auto& [block, reason] : wrong) {
        SCOPED_TRACE(reason);
        put("0/0/0", block);
        expectRefused(reason);
    }
}

TEST_F(N5Test, DamagedStreamsOfLz4AreRefused) {
    put("attributes.json", metadata(R"({"type": "lz4"})"));
    putBlocks("", lz4Stream);
    const Text good = lz4Stream(Text(128, 'x'));
    Text foreign = good, bomb = good;
    foreign[3] = 'x';
    bomb.replace(13, 4, bytesOf(std::uint32_t{1} << 31));
    for (const Text& stream :
         {Text(), Text("LZ4Block"), good.substr(0, good.size() - 1), good + "x", foreign, bomb,
          good.substr(0, good.size() - 21), lz4Stream(Text(256, 'x'))}) {
        put("0/0/0", headerOf(4, 4, 4) + stream);
        expectRefused("its lz4 data are damaged");
    }
    put("0/0/0", headerOf(4, 4, 4) + good);
    EXPECT_EQ(readVolume(root_).volume.view().as<std::int16_t>().at(0, 0, 0), 0x7878);
}

TEST_F(N5Test, WhatIsNotReadIsRefusedByName) {
    const std::pair<std::string, std::string> wrong[] = {
        {metadata(R"({"type": "bzip2"})"), "compression bzip2 is not read here"},
        {metadata(R"({"type": "xz"})"), "compression xz"},
        {metadata(R"({"type": "jpeg"})"), "compression jpeg"},
        {metadata("7"), "no type"},
        {metadata(R"({"type": "raw"})", R"(, "dataType": "string")"), "dataType string"},
        {metadata(R"({"type": "raw"})", R"(, "blockSize": [4, 4])"), "contradict each other"},
        {metadata(R"({"type": "raw"})", R"(, "blockSize": [4, 0, 4])"), "no list of whole numbers"},
        {metadata(R"({"type": "raw"})", R"(, "dimensions": [4, 4], "blockSize": [4, 4])"),
         "2 dimensions"},
        {metadata(R"({"type": "raw"})", R"(, "pixelResolution": [1, 0, 1])"), "pixelResolution"},
        {metadata(R"({"type": "raw"})", R"(, "pixelResolution": {"unit": "furlong",
                                            "dimensions": [1, 1, 1]})"),
         "unit 'furlong'"},
        {metadata(R"({"type": "raw"})", R"(, "axes": ["x", "y"])"), "axes"},
        {metadata(R"({"type": "raw"})", R"(, "resolution": [1, 1, 1], "units": "nm")"), "units"},
        {metadata(R"({"type": "raw"})", R"(, "affineTransform": [1])"), "affineTransform"},
        {R"({"n5": "2.5.0"})", "is a container of N5 that is no image itself"}};
    for (const auto& [text, reason] : wrong) {
        SCOPED_TRACE(reason);
        put("attributes.json", text);
        expectRefused(reason);
    }
    putArray("");
    ReadOptions options;
    options.level = 1;
    expectRefused("is one array, which has no levels; leave --level out", options);
    fs::remove_all(root_);
    putArray("s0/");
    putArray("s1/");
    expectValues(readVolume(root_));
    expectRefused("nothing says how coarse level 1 is", options);
}

TEST_F(N5Test, AnotherProgramsAttributesMakeNoN5) {
    put("attributes.json", "not JSON");
    expectRefused("no DICOM file found");
    put("attributes.json", R"({"dimension": 3})");
    expectRefused("no DICOM file found");
    fs::resize_file(root_ / "attributes.json", std::uintmax_t{17} << 20);
    expectRefused("no DICOM file found");
}

}  // namespace
}  // namespace adaptiso
