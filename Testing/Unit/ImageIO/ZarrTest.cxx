#include <blosc.h>
#include <gtest/gtest.h>
#include <lz4.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "ZarrCodecs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ImageRegions.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

using Text = std::string;

constexpr int kX = 7, kY = 6, kZ = 5;  // samples
constexpr int kChunk = 4;              // a side: ragged at every end
constexpr int kChunksX = 2, kChunksY = 2, kChunksZ = 2;

/// What the voxel holds, in every test.
std::int16_t valueAt(int x, int y, int z) {
    return static_cast<std::int16_t>(100 * z + 10 * y + x - 300);
}

Text bytesOf(std::int16_t value, bool isBig) {
    const auto bits = static_cast<std::uint16_t>(value);
    const char low = static_cast<char>(bits & 0xff), high = static_cast<char>(bits >> 8);
    return isBig ? Text{high, low} : Text{low, high};
}

/// The samples of a chunk, padded with 7; \param isF  x slowest
Text chunkAt(int cx, int cy, int cz, bool isF = false, bool isBig = false, int side = kChunk) {
    Text text;
    for (int a = 0; a < side; ++a) {
        for (int b = 0; b < side; ++b) {
            for (int c = 0; c < side; ++c) {
                const int x = cx * side + (isF ? a : c), y = cy * side + b,
                          z = cz * side + (isF ? c : a);
                const bool isInside = x < kX && y < kY && z < kZ;
                text += bytesOf(isInside ? valueAt(x, y, z) : std::int16_t{7}, isBig);
            }
        }
    }
    return text;
}

Text deflated(const Text& text, bool isGzip) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, isGzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY);
    Text out(text.size() + 1000, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

Text zstd(const Text& text) {
    Text out(ZSTD_compressBound(text.size()), '\0');
    out.resize(ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
    return out;
}

Text blosc(const Text& text, const char* inner) {
    Text out(text.size() + BLOSC_MAX_OVERHEAD, '\0');
    const int size =
        blosc_compress_ctx(5, 1, 2, text.size(), text.data(), out.data(), out.size(), inner, 0, 1);
    out.resize(static_cast<std::size_t>(size));
    return out;
}

Text lz4(const Text& text) {
    Text out(static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(text.size()))), '\0');
    out.resize(static_cast<std::size_t>(LZ4_compress_default(
        text.data(), out.data(), static_cast<int>(text.size()), static_cast<int>(out.size()))));
    Text size;
    for (int n = 0; n < 4; ++n) size += static_cast<char>(text.size() >> (8 * n) & 0xff);
    return size + out;
}

Text withSum(const Text& text) {
    const std::uint32_t sum = detail::crc32c(std::as_bytes(std::span(text.data(), text.size())));
    Text all = text;
    for (int n = 0; n < 4; ++n) all += static_cast<char>(sum >> (8 * n) & 0xff);
    return all;
}

class ZarrTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        root_ = fs::path(::testing::TempDir()) / ("Zarr-" + std::string(test->name()));
        fs::remove_all(root_);
    }
    void TearDown() override { fs::remove_all(root_); }

    void put(const std::string& key, const Text& text) const {
        fs::create_directories((root_ / key).parent_path());
        std::ofstream(root_ / key, std::ios::binary) << text;
    }

    static Text metadata2(const std::string& compressor, const std::string& more = "",
                          const std::string& dtype = "<i2", const std::string& order = "C") {
        return R"({"zarr_format": 2, "shape": [5, 6, 7], "chunks": [4, 4, 4], "dtype": ")" + dtype +
               R"(", "order": ")" + order + R"(", "fill_value": -9, "filters": null, )" +
               R"("compressor": )" + compressor + more + "}";
    }

    static Text metadata3(const std::string& codecs, const std::string& more = "") {
        return R"({"zarr_format": 3, "node_type": "array", "shape": [5, 6, 7],
                   "data_type": "int16", "fill_value": -9,
                   "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [4, 4, 4]}},
                   "chunk_key_encoding": {"name": "default"}, "codecs": )" +
               codecs + more + "}";
    }

    /// All chunks, packed by `pack`, under prefix and numbers with a separator between.
    void putChunks(const std::string& prefix, const std::string& separator,
                   const std::function<Text(const Text&)>& pack, bool isF = false,
                   bool isBig = false) const {
        for (int z = 0; z < kChunksZ; ++z) {
            for (int y = 0; y < kChunksY; ++y) {
                for (int x = 0; x < kChunksX; ++x) {
                    put(prefix + std::to_string(z) + separator + std::to_string(y) + separator +
                            std::to_string(x),
                        pack(chunkAt(x, y, z, isF, isBig)));
                }
            }
        }
    }

    /// \param options  that it was read with
    void expectValues(const ReadVolume& read, const ReadOptions& options = {}) const {
        expectValues(read, root_, options);
    }
    void expectValues(const ReadVolume& read, const fs::path& folder,
                      const ReadOptions& options = {}) const {
        const TypedVolumeView<std::int16_t> view = read.volume.view().as<std::int16_t>();
        ASSERT_EQ(view.geometry.size, (Index3{kX, kY, kZ}));
        for (int z = 0; z < kZ; ++z) {
            for (int y = 0; y < kY; ++y) {
                for (int x = 0; x < kX; ++x) ASSERT_EQ(view.at(x, y, z), valueAt(x, y, z));
            }
        }
        expectParts(folder, options);
    }

    /// What ImageRegions reads, over and beside the walls of chunks.
    void expectParts(const fs::path& folder, const ReadOptions& options) const {
        const ImageRegions image = ImageRegions::open(folder, options);
        EXPECT_TRUE(image.readsParts());
        for (const auto& [first, size] : {std::pair<Index3, Index3>{{0, 0, 0}, {kX, kY, kZ}},
                                          {{3, 3, 3}, {2, 2, 2}},
                                          {{1, 4, 0}, {5, 2, 1}},
                                          {{6, 5, 4}, {1, 1, 1}},
                                          {{0, 0, 2}, {4, 4, 2}}}) {
            const Volume part = image.read(first, size);
            const TypedVolumeView<std::int16_t> view = part.view().as<std::int16_t>();
            ASSERT_EQ(view.geometry.size, size);
            const Vec3 low{static_cast<double>(first[0]), static_cast<double>(first[1]),
                           static_cast<double>(first[2])};
            EXPECT_EQ(view.geometry.originMm, image.geometry().toPhysical(low));
            for (int z = 0; z < size[2]; ++z) {
                for (int y = 0; y < size[1]; ++y) {
                    for (int x = 0; x < size[0]; ++x) {
                        ASSERT_EQ(view.at(x, y, z), valueAt(static_cast<int>(first[0]) + x,
                                                            static_cast<int>(first[1]) + y,
                                                            static_cast<int>(first[2]) + z));
                    }
                }
            }
            EXPECT_EQ(image.constantIn(first, size), std::nullopt);
        }
    }

    void expectRefused(const std::string& reason, const ReadOptions& options = {}) const {
        try {
            readVolume(root_, options);
            FAIL() << "was read; should say: " << reason;
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }

    fs::path root_;
};

Text same(const Text& text) {
    return text;
}

TEST_F(ZarrTest, Version2IsReadInEveryCodecOrderAndByteOrder) {
    const std::pair<std::string, std::function<Text(const Text&)>> codecs[] = {
        {"null", same},
        {R"({"id": "zlib", "level": 1})", [](const Text& t) { return deflated(t, false); }},
        {R"({"id": "gzip", "level": 1})", [](const Text& t) { return deflated(t, true); }},
        {R"({"id": "zstd", "level": 1})", zstd},
        {R"({"id": "lz4", "acceleration": 1})", lz4},
        {R"({"id": "blosc", "cname": "lz4"})", [](const Text& t) { return blosc(t, "lz4"); }},
        {R"({"id": "blosc", "cname": "zstd"})", [](const Text& t) { return blosc(t, "zstd"); }},
        {R"({"id": "blosc", "cname": "zlib"})", [](const Text& t) { return blosc(t, "zlib"); }},
        {R"({"id": "blosc", "cname": "blosclz"})",
         [](const Text& t) { return blosc(t, "blosclz"); }}};
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
         [](const Text& t) { return deflated(t, true); }},
        {R"(, {"name": "zstd", "configuration": {"level": 5}})", zstd},
        {R"(, {"name": "blosc", "configuration": {}})",
         [](const Text& t) { return blosc(t, "lz4"); }},
        {R"(, {"name": "crc32c"})", withSum},
        {R"(, {"name": "zstd"}, {"name": "crc32c"})",
         [](const Text& t) { return withSum(zstd(t)); }},
        {R"(, {"name": "blosc"}, {"name": "gzip"})",
         [](const Text& t) { return deflated(blosc(t, "zstd"), true); }}};
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

/// One shard of 2 x 2 x 2 chunks of side 2 each: 4 a side, twice in each direction.
TEST_F(ZarrTest, ShardsAreReadWithTheirIndexAtEitherEndAndHoles) {
    for (const bool isAtEnd : {true, false}) {
        SCOPED_TRACE(isAtEnd ? "end" : "start");
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
                if (x == 0 && y == 0 && z == 0) {  // left out
                    add(~std::uint64_t{0});
                    add(~std::uint64_t{0});
                    continue;
                }
                const Text packed = zstd(chunkAt(x, y, z, false, false, 2));
                add(begin + data.size());
                add(packed.size());
                data += packed;
            }
            put("c/" + std::to_string(sz) + "/" + std::to_string(sy) + "/" + std::to_string(sx),
                isAtEnd ? data + withSum(index) : withSum(index) + data);
        }
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
        EXPECT_NE(read.warnings.back().find("1 of its 36 chunks"), std::string::npos)
            << read.warnings.back();
        expectRefused("1 of its 36 chunks are not there", {.refusesMissingChunks = true});
    }
}

TEST_F(ZarrTest, OnlyAChunkThatIsNotThereIsFill) {
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    fs::remove(root_ / "1.0.1");
    const ReadVolume read = readVolume(root_);
    EXPECT_EQ(read.volume.view().as<std::int16_t>().at(4, 0, 4), -9);
    EXPECT_NE(read.warnings.back().find("1 of its 8 chunks are not there"), std::string::npos);
    expectRefused("1 of its 8 chunks are not there", {.refusesMissingChunks = true});

    put("1.0.1", "");
    expectRefused("1.0.1: is empty");
    put("1.0.1", chunkAt(1, 0, 1).substr(0, 100));
    expectRefused("1.0.1: holds 100 bytes of a chunk of 128");
    put("1.0.1", chunkAt(1, 0, 1) + "x");
    expectRefused("1.0.1: holds 129 bytes of a chunk of 128");
    put("1.0.1", Text(1 << 20, 'x'));
    expectRefused("more than a chunk of 128 can take");
    fs::remove(root_ / "1.0.1");
    fs::create_directories(root_ / "1.0.1");
    expectRefused("1.0.1: is not a file");
    fs::remove(root_ / "1.0.1");
    fs::create_symlink("/dev/zero", root_ / "1.0.1");
    expectRefused("1.0.1");
    fs::remove(root_ / "1.0.1");
    fs::create_symlink("nowhere", root_ / "1.0.1");
    expectRefused("1.0.1");
}

TEST_F(ZarrTest, LinksLeadNowhereButIntoTheDatasetAndItsAnnex) {
    const fs::path outside = root_.string() + "-outside";
    fs::remove_all(outside);
    fs::create_directories(outside);
    put("d/.zarray", metadata2("null", R"(, "dimension_separator": "/")"));
    put("d/.zgroup", "{}");
    fs::remove(root_ / "d/.zgroup");
    const fs::path array = root_ / "d";
    putChunks("d/", "/", same);
    const auto refused = [&] {
        try {
            readVolume(array);
        } catch (const FileError& error) {
            return std::string(error.what()).find("outside of its dataset") != std::string::npos;
        }
        return false;
    };
    // git-annex: content lies above the array, under .git/annex/objects
    fs::create_directories(root_ / ".git/annex/objects/a");
    fs::rename(array / "0/0/0", root_ / ".git/annex/objects/a/key");
    fs::create_symlink("../../../.git/annex/objects/a/key", array / "0/0/0");
    expectValues(readVolume(array), array);
    // another file of the dataset
    fs::rename(array / "0/0/1", array / "kept");
    fs::create_symlink("../../kept", array / "0/0/1");
    expectValues(readVolume(array), array);
    // a file elsewhere, a folder elsewhere, a way up and out
    fs::rename(array / "0/1/0", outside / "file");
    fs::create_symlink(outside / "file", array / "0/1/0");
    EXPECT_TRUE(refused());
    fs::remove(array / "0/1/0");
    fs::rename(outside / "file", array / "0/1/0");
    fs::rename(array / "1", outside / "folder");
    fs::create_directory_symlink(outside / "folder", array / "1");
    EXPECT_TRUE(refused());
    fs::remove(array / "1");
    fs::rename(outside / "folder", root_ / "1");
    fs::create_directory_symlink("../1", array / "1");
    EXPECT_TRUE(refused());
    fs::remove_all(outside);
}

TEST_F(ZarrTest, MetadataAsDeepAsAHostileFileLikesAreRefused) {
    constexpr std::size_t kDepth = 200000;
    const Text deep = Text(kDepth, '[') + Text(kDepth, ']');
    put(".zarray", metadata2("null", R"(, "fill_value": )" + deep));
    expectRefused("fill_value [...] is none of its type");
    put(".zarray", metadata2("null", R"(, "dimension_separator": )" + deep));
    expectRefused("dimension_separator");
    fs::remove_all(root_);
    put("zarr.json",
        metadata3(R"([{"name": "bytes", "configuration": {"endian": )" + deep + "}}]"));
    expectRefused("endian");
    fs::remove_all(root_);
    put(".zattrs",
        R"({"multiscales": [{"axes": [{"name": "x", "type": "space", "unit": )" + deep + "}]}]}");
    expectRefused("unit [...]");
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

TEST_F(ZarrTest, AChunkThatCannotBeOpenedIsNoFill) {
    if (geteuid() == 0) GTEST_SKIP() << "root may open everything";
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    chmod((root_ / "0.0.0").c_str(), 0);
    expectRefused("0.0.0: can't be opened");
}

TEST_F(ZarrTest, DamagedChunksAndBombsAreRefused) {
    const std::pair<std::string, Text> bombs[] = {
        {R"({"id": "zlib"})", deflated(Text(1 << 24, '\0'), false)},
        {R"({"id": "zstd"})", zstd(Text(1 << 24, '\0'))},
        {R"({"id": "lz4"})", lz4(Text(1 << 20, '\0'))},
        {R"({"id": "blosc"})", blosc(Text(1 << 21, '\0'), "lz4")}};
    for (const auto& [codec, bomb] : bombs) {
        SCOPED_TRACE(codec);
        put(".zarray", metadata2(codec));
        putChunks("", ".", [&](const Text&) { return bomb; });
        expectRefused("data are damaged, or unpack to more than a chunk");
        putChunks("", ".",
                  [](const Text&) { return Text("\2\1\3\2rubbish that is none of them"); });
        expectRefused("data are damaged");
        putChunks("", ".", [&](const Text&) { return bomb.substr(0, bomb.size() / 2); });
        expectRefused("damaged");
    }
    put(".zarray", metadata2("null"));
    fs::remove(root_ / ".zarray");
    put("zarr.json", metadata3(R"([{"name": "bytes"}, {"name": "crc32c"}])"));
    putChunks("c/", "/", [](const Text& text) {
        Text damaged = withSum(text);
        damaged[5] ^= 1;
        return damaged;
    });
    expectRefused("its checksum (crc32c) differs");
}

TEST_F(ZarrTest, WhatIsNotReadIsRefusedByName) {
    const std::pair<std::string, std::string> wrong2[] = {
        {metadata2(R"({"id": "bz2"})"), "codec bz2"},
        {metadata2("null", "", "<f2"), "dtype <f2"},
        {metadata2("null", "", "|S7"), "dtype |S7"},
        {metadata2("null", R"(, "filters": [{"id": "delta"}])"), "filter delta"},
        {metadata2("null", "", "<i2", "A"), "order A"},
        {metadata2("null", R"(, "shape": [5, 6, 7, 0])"), "shape is no list of whole numbers"},
        {metadata2("null", R"(, "chunks": [4, 4])"), "contradict each other"},
        {metadata2("null", R"(, "chunks": [4, 4, 4294967296])"), "larger than what is read here"},
        {metadata2("null", R"(, "fill_value": 40000)"), "fill_value 40000 is none of its type"},
        {metadata2("null", R"(, "zarr_format": 1)"), "zarr_format is not 2"},
        {"[]", "no JSON object"},
        {metadata2("null", R"(, "shape": [281474976710656, 281474976710656, 2])"), "more memory"}};
    for (const auto& [text, reason] : wrong2) {
        SCOPED_TRACE(reason);
        put(".zarray", text);
        expectRefused(reason);
    }
    fs::remove_all(root_);
    const std::pair<std::string, std::string> wrong3[] = {
        {metadata3(R"([{"name": "bytes"}, {"name": "zfp"}])"), "codec zfp"},
        {metadata3(R"([{"name": "numcodecs.pcodec"}])"), "codec numcodecs.pcodec"},
        {metadata3(R"([{"name": "bytes"}, {"name": "sharding_indexed"}])"),
         "sharding_indexed within"},
        {metadata3(R"([{"name": "bytes"}])", R"(, "storage_transformers": [{"name": "st"}])"),
         "storage transformer st"},
        {metadata3(R"([{"name": "bytes"}])", R"(, "secret": {"x": 1})"), "member secret"},
        {metadata3(R"([{"name": "bytes"}])", R"(, "data_type": "float16")"), "data_type float16"},
        {metadata3(R"([{"name": "transpose", "configuration": {"order": [0, 0, 1]}},
                       {"name": "bytes"}])"),
         "codec transpose"}};
    for (const auto& [text, reason] : wrong3) {
        SCOPED_TRACE(reason);
        put("zarr.json", text);
        expectRefused(reason);
    }
}

/// time, channel, z, y, x of an OME-Zarr: two time points and channels of whole chunks.
class OmeZarrTest : public ZarrTest {
protected:
    void putLevel(const std::string& path, int time, int channel) const {
        put(path + "/.zarray",
            R"({"zarr_format": 2, "shape": [2, 3, 5, 6, 7], "chunks": [1, 1, 4, 4, 4],
                "dtype": "<i2", "order": "C", "fill_value": 0, "filters": null,
                "compressor": null, "dimension_separator": "/"})");
        putChunks(path + "/" + std::to_string(time) + "/" + std::to_string(channel) + "/", "/",
                  same);
    }
    static Text multiscales(const std::string& version, const std::string& unit = "micrometer") {
        const std::string space = R"(, "type": "space", "unit": ")" + unit + R"("})";
        return R"([{)" + version + R"("axes": [{"name": "t", "type": "time"},
            {"name": "c", "type": "channel"}, {"name": "z")" +
               space + R"(, {"name": "y")" + space + R"(, {"name": "x")" + space + R"(],
            "datasets": [
              {"path": "0", "coordinateTransformations": [
                 {"type": "scale", "scale": [1, 1, 3, 2, 1]},
                 {"type": "translation", "translation": [0, 0, 30, 20, 10]}]},
              {"path": "deep/1", "coordinateTransformations": [
                 {"type": "scale", "scale": [1, 1, 6, 4, 2]}]}],
            "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 10, 10, 10]}]}])";
    }
    static ReadOptions at(int time, int channel, std::optional<std::int64_t> level = {}) {
        ReadOptions options;
        options.timePoint = time;
        options.channel = channel;
        options.level = level;
        return options;
    }
};

TEST_F(OmeZarrTest, Version04HasItsLevelsChannelsTimesAndUnits) {
    put(".zattrs", R"({"multiscales": )" + multiscales(R"("version": "0.4", )") + "}");
    put(".zgroup", R"({"zarr_format": 2})");
    putLevel("0", 1, 2);
    putLevel("deep/1", 0, 1);
    const ReadVolume read = readVolume(root_, at(1, 2));
    expectValues(read, at(1, 2));
    EXPECT_EQ(read.format, "OME-Zarr 0.4");
    // micrometres: 10 times (3, 2, 1), and of the translation
    const ImageGeometry& geometry = read.volume.view().geometry();
    EXPECT_NEAR(geometry.spacingMm()[0], 0.01, 1e-15);
    EXPECT_NEAR(geometry.spacingMm()[2], 0.03, 1e-15);
    EXPECT_NEAR(geometry.originMm[0], 0.1, 1e-15);
    EXPECT_NEAR(geometry.originMm[2], 0.3, 1e-15);
    const ReadVolume coarse = readVolume(root_, at(0, 1, 1));
    expectValues(coarse, at(0, 1, 1));
    EXPECT_NEAR(coarse.volume.view().geometry().spacingMm()[1], 0.04, 1e-15);
    EXPECT_EQ(coarse.volume.view().geometry().originMm[0], 0);

    expectRefused("holds 2 time points; choose one, 0 to 1 (--time)");
    expectRefused("there is no channel 3: it holds 3; choose one, 0 to 2 (--channel)", at(0, 3));
    expectRefused("there is no level 2: it holds 2; choose one, 0 to 1 (--level)", at(0, 1, 2));
}

TEST_F(OmeZarrTest, Version05LiesInTheAttributes) {
    put("zarr.json", R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome":
        {"version": "0.5", "multiscales": )" +
                         multiscales("") + "}}}");
    putLevel("0", 1, 2);
    const ReadVolume read = readVolume(root_, at(1, 2));
    expectValues(read, at(1, 2));
    EXPECT_EQ(read.format, "OME-Zarr 0.5");
}

TEST_F(OmeZarrTest, OtherVersionsUnitsAndPathsAreRefusedByName) {
    const std::pair<std::string, std::string> wrong[] = {
        {R"({"multiscales": )" + multiscales(R"("version": "0.3", )") + "}", "OME-Zarr 0.3"},
        {R"({"multiscales": )" + multiscales("", "furlong") + "}", "unit furlong"},
        {R"({"bioformats2raw.layout": 3})", "holds several images"},
        {R"({"multiscales": []})", "multiscales is no list"},
        {R"({"multiscales": [{"axes": [{"name": "x", "type": "space"}],
             "datasets": [{"path": "../0"}]}]})",
         "leads out of it"},
        {R"({"multiscales": [{"axes": [{"name": "x", "type": "space"}], "datasets": [{"path": "0",
             "coordinateTransformations": [{"type": "affine"}]}]}]})",
         "transformation affine"},
        {R"({"x": 1})", "is a group of Zarr that is no image"}};
    for (const auto& [text, reason] : wrong) {
        SCOPED_TRACE(reason);
        put(".zattrs", text);
        expectRefused(reason);
    }
    fs::remove_all(root_);
    put("zarr.json", R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome":
        {"version": "0.6.dev3", "multiscales": []}}})");
    expectRefused("OME-Zarr 0.6.dev3");
}

TEST_F(OmeZarrTest, UnitsOfSomeAxesOnlyAreRefused) {
    Text some = multiscales(R"("version": "0.4", )");
    some.replace(some.find(R"(, "unit": "micrometer")"), Text(R"(, "unit": "micrometer")").size(),
                 "");
    put(".zattrs", R"({"multiscales": )" + some + "}");
    put(".zgroup", R"({"zarr_format": 2})");
    putLevel("0", 1, 2);
    expectRefused("some of its axes in space have a unit, others none", at(1, 2));
}

TEST_F(ZarrTest, AnotherProgramsAttributesMakeNoN5) {
    put("attributes.json", "not JSON");
    expectRefused("no DICOM file found");
    put("attributes.json", R"({"dimension": 3})");
    expectRefused("no DICOM file found");
    fs::resize_file(root_ / "attributes.json", std::uintmax_t{17} << 20);
    expectRefused("no DICOM file found");
}

TEST_F(ZarrTest, N5IsToldByName) {
    put("attributes.json", R"({"dimensions": [5, 6, 7], "blockSize": [4, 4, 4]})");
    expectRefused("is N5, which is not read here; convert it to Zarr");
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
