#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ZarrCodecs.h"
#include "ZarrFolder.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ImageRegions.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace testing;

class ZarrTest : public ZarrFolder {};

TEST_F(ZarrTest, Version2IsReadInEveryCodecOrderAndByteOrder) {
    const std::pair<std::string, std::function<Text(const Text&)>> codecs[] = {
        {"null", same},
        {R"({"id": "zlib", "level": 1})", [](const Text& t) { return zlibbed(t); }},
        {R"({"id": "gzip", "level": 1})", [](const Text& t) { return gzipped(t); }},
        {R"({"id": "zstd", "level": 1})", zstdOf},
        {R"({"id": "lz4", "acceleration": 1})", lz4Of},
        {R"({"id": "blosc", "cname": "lz4"})", [](const Text& t) { return bloscOf(t, "lz4"); }},
        {R"({"id": "blosc", "cname": "zstd"})", [](const Text& t) { return bloscOf(t, "zstd"); }},
        {R"({"id": "blosc", "cname": "zlib"})", [](const Text& t) { return bloscOf(t, "zlib"); }},
        {R"({"id": "blosc", "cname": "blosclz"})",
         [](const Text& t) { return bloscOf(t, "blosclz"); }}};
    for (const auto& [metadata, pack] : codecs) {
        for (const bool isF : {false, true}) {
            for (const bool isBig : {false, true}) {
                SCOPED_TRACE(metadata + (isF ? " F" : " C") + (isBig ? " big" : " little"));
                fs::remove_all(root_);
                put(".zarray", metadata2(metadata, "", isBig ? ">i2" : "<i2", isF ? "F" : "C"));
                putChunks("", ".", pack, isF, isBig);
                const ReadVolume read = readVolume(root_);
                expectValues(read);
                EXPECT_EQ(read.format, "Zarr 2");
            }
        }
    }
}

TEST_F(ZarrTest, Version3IsReadInEveryCodecAndTransposition) {
    const std::pair<std::string, std::function<Text(const Text&)>> codecs[] = {
        {"", same},
        {R"(, {"name": "gzip", "configuration": {"level": 5}})",
         [](const Text& t) { return gzipped(t); }},
        {R"(, {"name": "zstd", "configuration": {"level": 5}})", zstdOf},
        {R"(, {"name": "blosc", "configuration": {}})",
         [](const Text& t) { return bloscOf(t, "lz4"); }},
        {R"(, {"name": "crc32c"})", withSum},
        {R"(, {"name": "zstd"}, {"name": "crc32c"})",
         [](const Text& t) { return withSum(zstdOf(t)); }},
        {R"(, {"name": "blosc"}, {"name": "gzip"})",
         [](const Text& t) { return gzipped(bloscOf(t, "zstd")); }}};
    for (const auto& [metadata, pack] : codecs) {
        for (const bool isF : {false, true}) {
            SCOPED_TRACE(metadata + (isF ? " transposed" : ""));
            fs::remove_all(root_);
            const std::string transpose =
                isF ? R"({"name": "transpose", "configuration": {"order": [2, 1, 0]}}, )" : "";
            put("zarr.json", metadata3("[" + transpose +
                                       R"({"name": "bytes", "configuration": {"endian": "big"}})" +
                                       metadata + "]"));
            putChunks("c/", "/", pack, isF, true);
            const ReadVolume read = readVolume(root_);
            expectValues(read);
            EXPECT_EQ(read.format, "Zarr 3");
        }
    }
}

TEST_F(ZarrTest, PartsWithoutChunksAreKnownWithoutReading) {
    put(".zarray", metadata2("null"));
    put("1.1.1", chunkAt(1, 1, 1));
    const ImageRegions image = ImageRegions::open(root_, {});
    EXPECT_EQ(image.constantIn({0, 0, 0}, {4, 6, 5}), -9);
    EXPECT_EQ(image.constantIn({0, 0, 0}, {5, 5, 5}), std::nullopt);
    EXPECT_EQ(image.read({0, 0, 0}, {2, 2, 2}).view().as<std::int16_t>().at(1, 1, 1), -9);
    // a chunk that is not looked at does not matter, one that changes does
    const std::string before = image.stampOf({4, 4, 4}, {1, 1, 1}),
                      aside = image.stampOf({0, 0, 0}, {4, 4, 4});
    put("1.1.1", chunkAt(1, 1, 1) + Text(1, 'x'));
    EXPECT_NE(image.stampOf({4, 4, 4}, {1, 1, 1}), before);
    EXPECT_EQ(image.stampOf({0, 0, 0}, {4, 4, 4}), aside);
    put(".zarray", metadata2("null", R"(, "fill_value": 8)"));  // what chunks that are missing hold
    EXPECT_NE(ImageRegions::open(root_, {}).stampOf({0, 0, 0}, {4, 4, 4}), aside);
    put(".zarray", metadata2("null"));
    EXPECT_THROW(image.read({4, 4, 4}, {1, 1, 1}), FileError);
    ReadOptions strict;
    strict.refusesMissingChunks = true;
    const ImageRegions refusing = ImageRegions::open(root_, strict);
    EXPECT_EQ(refusing.constantIn({0, 0, 0}, {4, 6, 5}), std::nullopt);
    EXPECT_THROW(refusing.read({0, 0, 0}, {1, 1, 1}), FileError);
}

TEST_F(ZarrTest, KeysAreAsTheMetadataSay) {
    put(".zarray", metadata2("null", R"(, "dimension_separator": "/")"));
    putChunks("", "/", same);
    expectValues(readVolume(root_));
    fs::remove_all(root_);
    Text v2Keys = metadata3(R"([{"name": "bytes"}])");
    v2Keys.replace(v2Keys.find(R"({"name": "default"})"), 19, R"({"name": "v2"})");
    put("zarr.json", v2Keys);
    putChunks("", ".", same);
    expectValues(readVolume(root_));
}

/// Shards of 2 x 2 x 2 chunks of side 2 each: 4 a side, twice in each direction. The first chunk is
/// left out.
class ZarrShardsTest : public ZarrFolder {
protected:
    /// \param change  of the samples of the chunk at x, y, z
    void putShards(bool isAtEnd, const std::function<Text(const Text&, int, int, int)>& change) {
        fs::remove_all(root_);
        put("zarr.json",
            metadata3(R"([{"name": "sharding_indexed", "configuration": {"chunk_shape": [2, 2, 2],
                "codecs": [{"name": "bytes"}, {"name": "zstd"}],
                "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}},
                                 {"name": "crc32c"}],
                "index_location": ")" +
                      std::string(isAtEnd ? "end" : "start") + R"("}}])"));
        for (int shard = 0; shard < 8; ++shard) {
            const int sx = shard & 1, sy = shard >> 1 & 1, sz = shard >> 2;
            Text data, index;
            const auto add = [&](std::uint64_t number) {
                for (int n = 0; n < 8; ++n) index += static_cast<char>(number >> (8 * n) & 0xff);
            };
            const std::uint64_t begin = isAtEnd ? 0 : 8 * 16 + 4;
            for (int inner = 0; inner < 8; ++inner) {
                const int x = 2 * sx + (inner & 1), y = 2 * sy + (inner >> 1 & 1),
                          z = 2 * sz + (inner >> 2);
                if (x == 0 && y == 0 && z == 0) {
                    add(~std::uint64_t{0});
                    add(~std::uint64_t{0});
                    continue;
                }
                const Text packed = zstdOf(change(chunkAt(x, y, z, false, false, 2), x, y, z));
                add(begin + data.size());
                add(packed.size());
                data += packed;
            }
            put("c/" + std::to_string(sz) + "/" + std::to_string(sy) + "/" + std::to_string(sx),
                isAtEnd ? data + withSum(index) : withSum(index) + data);
        }
    }
};

TEST_F(ZarrShardsTest, AreReadWithTheirIndexAtEitherEndAndHoles) {
    for (const bool isAtEnd : {true, false}) {
        SCOPED_TRACE(isAtEnd ? "end" : "start");
        putShards(isAtEnd, [](const Text& chunk, int, int, int) { return chunk; });
        const ReadVolume read = readVolume(root_);
        const auto view = read.volume.view().as<std::int16_t>();
        for (int z = 0; z < kZ; ++z) {
            for (int y = 0; y < kY; ++y) {
                for (int x = 0; x < kX; ++x) {
                    const bool isHole = x < 2 && y < 2 && z < 2;
                    ASSERT_EQ(view.at(x, y, z), isHole ? -9 : valueAt(x, y, z));
                }
            }
        }
        // 4 x 3 x 3 inner chunks of 2 hold 7 x 6 x 5 samples
        EXPECT_NE(read.warnings.back().text.find("1 of its 36 chunks"), std::string::npos)
            << read.warnings.back().text;
        expectRefused("1 of its 36 chunks are not there", {.refusesMissingChunks = true});
    }
}

/// 5 samples along z are three chunks; shards have room for a fourth.
TEST_F(ZarrShardsTest, ValuesOfChunksWhollyBeyondTheShapeAreNamed) {
    const auto mentionsBeyond = [&](int changed) {
        putShards(true, [&](Text chunk, int x, int y, int z) {
            if (x == 1 && y == 2 && z == changed) chunk.back() = 8;
            return chunk;
        });
        const ReadVolume read = readVolume(root_);
        return std::ranges::any_of(read.warnings, [](const Warning& warning) {
            return warning.code == "trailing-bytes" &&
                   warning.text.find("beyond the shape that its metadata state (5 x 6 x 7)") !=
                       std::string::npos;
        });
    };
    EXPECT_FALSE(mentionsBeyond(-1));  // 7 again and again
    EXPECT_TRUE(mentionsBeyond(3));
}

TEST_F(ZarrTest, IndicesOfAxesThatAreNotThereAreRefused) {
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    ReadOptions options;
    options.channel = 1;
    expectRefused("there is no channel 1: it has no such axis; leave --channel out", options);
    options = {};
    options.timePoint = 2;
    expectRefused("there is no time point 2", options);
    options = {};
    options.volumeIndex = 1;
    expectRefused("there is no volume 1", options);
    options.volumeIndex = 0;  // as of a NIfTI file of one volume
    expectValues(readVolume(root_, options), options);
}

TEST(Crc32c, IsThatOfItsSpecification) {
    // RFC 3720, B.4: 32 bytes of zeros, of ones, and 0 to 31
    EXPECT_EQ(detail::crc32c(std::vector<std::byte>(32, std::byte{0})), 0x8a9136aaU);
    EXPECT_EQ(detail::crc32c(std::vector<std::byte>(32, std::byte{0xff})), 0x62a8ab43U);
    std::vector<std::byte> rising;
    for (int n = 0; n < 32; ++n) rising.push_back(static_cast<std::byte>(n));
    EXPECT_EQ(detail::crc32c(rising), 0x46dd794eU);
}

}  // namespace
}  // namespace adaptiso
