#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "ZarrFolder.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace testing;

class ZarrRefusalTest : public ZarrFolder {};

TEST_F(ZarrRefusalTest, OnlyAChunkThatIsNotThereIsFill) {
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    fs::remove(root_ / "1.0.1");
    const ReadVolume read = readVolume(root_);
    EXPECT_EQ(read.volume.view().as<std::int16_t>().at(4, 0, 4), -9);
    EXPECT_NE(read.warnings.back().text.find("1 of its 8 chunks are not there"), std::string::npos);
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

TEST_F(ZarrRefusalTest, ChunksBeyondTheShapeAreMoreOfTheImage) {
    const auto expectBeyond = [&](const std::string& prefix, const std::string& separator) {
        for (int dimension = 0; dimension < 3; ++dimension) {
            std::string key = prefix;
            for (int n = 0; n < 3; ++n) {
                key += (n == 0 ? "" : separator) + std::string(n == dimension ? "2" : "0");
            }
            SCOPED_TRACE(key);
            put(key, chunkAt(0, 0, 0));
            expectRefused("beyond the shape that its metadata state (5 x 6 x 7): " + key);
            fs::remove(root_ / key);
            expectValues(readVolume(root_));  // folders may be left behind
        }
    };
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    expectBeyond("", ".");
    for (const char* const other : {"2.0.0.0", "2.0", "02.0.0", "2.0.0.partial", "x.0.0", "2"}) {
        put(other, "no chunk");
    }
    expectValues(readVolume(root_));
    fs::remove_all(root_);
    put(".zarray", metadata2("null", R"(, "dimension_separator": "/")"));
    putChunks("", "/", same);
    expectBeyond("", "/");
    fs::remove_all(root_);
    put("zarr.json", metadata3(R"([{"name": "bytes", "configuration": {"endian": "little"}}])"));
    putChunks("c/", "/", same);
    expectBeyond("c/", "/");
    fs::remove_all(root_);
    put("zarr.json", metadata3(R"([{"name": "bytes", "configuration": {"endian": "little"}}])",
                               R"(, "chunk_key_encoding": {"name": "default",
                                  "configuration": {"separator": "."}})"));
    putChunks("c.", ".", same);
    expectBeyond("c.", ".");
}

/// Specification 2 leaves open what chunks hold there, so it is a warning; one value again and
/// again is what writers put there.
TEST_F(ZarrRefusalTest, ValuesBeyondTheShapeAreNamed) {
    const auto mentionsBeyond = [&] {
        for (const Warning& warning : readVolume(root_).warnings) {
            if (warning.code != "trailing-bytes") continue;
            EXPECT_NE(warning.text.find("beyond the shape that its metadata state (5 x 6 x 7)"),
                      std::string::npos)
                << warning.text;
            return true;
        }
        return false;
    };
    const std::pair<std::string, std::function<Text(const Text&)>> codecs[] = {
        {"null", same}, {R"({"id": "zlib"})", zlibbed}};
    for (const auto& [codec, pack] : codecs) {
        for (const bool isF : {false, true}) {
            put(".zarray", metadata2(codec, "", "<i2", isF ? "F" : "C"));
            putChunks("", ".", pack, isF);
            EXPECT_FALSE(mentionsBeyond());  // 7 again and again
            // the last sample of the last chunk lies beyond along all axes, that of the second one
            // along z
            for (const auto& [key, at] :
                 {std::pair{"1.1.1", std::array{1, 1, 1}}, {"1.0.0", std::array{0, 0, 1}}}) {
                const Text chunk = chunkAt(at[0], at[1], at[2], isF);
                Text other = chunk;
                other[other.size() - 2] = 8;
                put(key, pack(other));
                EXPECT_TRUE(mentionsBeyond()) << key;
                put(key, pack(chunk));
            }
        }
    }
    fs::remove_all(root_);
    put("zarr.json", metadata3(R"([{"name": "bytes", "configuration": {"endian": "little"}}])"));
    putChunks("c/", "/", same);
    EXPECT_FALSE(mentionsBeyond());
    Text other = chunkAt(1, 1, 1);
    other.back() = 8;
    put("c/1/1/1", other);
    EXPECT_TRUE(mentionsBeyond());
}

TEST_F(ZarrRefusalTest, LinksLeadNowhereButIntoTheDatasetAndItsAnnex) {
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
            return std::string(error.what()).find("link to outside of its folder") !=
                   std::string::npos;
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

TEST_F(ZarrRefusalTest, MetadataWithAKeyTwiceAreRefused) {
    Text text = metadata2("null");
    text.insert(1, R"("shape": [1, 1, 1], )");
    put(".zarray", text);
    expectRefused("has a key twice");
}

TEST_F(ZarrRefusalTest, MetadataAsDeepAsAHostileFileLikesAreRefused) {
    for (const std::size_t depth : {std::size_t{50}, std::size_t{200'000}}) {
        const Text deep = Text(depth, '[') + Text(depth, ']');
        const bool isRead = depth < 100;
        const auto expect = [&](const char* fault) {
            expectRefused(isRead ? fault : "is damaged: it is no JSON object");
            fs::remove_all(root_);
        };
        put(".zarray", metadata2("null", R"(, "fill_value": )" + deep));
        expect("fill_value [...] is none of its type");
        put(".zarray", metadata2("null", R"(, "dimension_separator": )" + deep));
        expect("dimension_separator");
        put("zarr.json",
            metadata3(R"([{"name": "bytes", "configuration": {"endian": )" + deep + "}}]"));
        expect("endian");
        put(".zattrs", R"({"multiscales": [{"axes": [{"name": "x", "type": "space", "unit": )" +
                           deep + "}]}]}");
        expect("unit '[...]'");
    }
}

TEST_F(ZarrRefusalTest, AnImageOfNextToNothingIsRefused) {
    // 1.3 GB, of which no chunk is there
    put(".zarray", R"({"zarr_format": 2, "shape": [1100, 1100, 1100], "chunks": [100, 100, 100],
        "dtype": "|u1", "order": "C", "fill_value": 0, "filters": null, "compressor": null})");
    expectRefused("its chunks of 0 bytes expand to a size of 1331000000");
}

TEST_F(ZarrRefusalTest, AChunkThatCannotBeOpenedIsNoFill) {
    if (geteuid() == 0) GTEST_SKIP() << "root may open everything";
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);
    chmod((root_ / "0.0.0").c_str(), 0);
    expectRefused("0.0.0: can't be opened");
}

TEST_F(ZarrRefusalTest, ChunksThatAreElsewhereAreNamed) {
    const std::pair<const char*, const char*> stands[] = {
        {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 1024\n",
         "is a git-lfs pointer"},
        {"<!DOCTYPE html><html>", "is a web page"}};
    for (const char* const codec : {"null", R"({"id": "zlib"})"}) {
        put(".zarray", metadata2(codec));
        for (const auto& [content, name] : stands) {
            putChunks("", ".", [held = content](const Text&) { return Text(held); });
            expectRefused(name);
        }
    }
    put(".zarray", metadata2("null"));
    putChunks("", ".", same);  // the chunk that is named first depends on the threads
    fs::remove(root_ / "0.0.0");
    fs::create_symlink("../.git/annex/objects/a/MD5E-s12--c", root_ / "0.0.0");
    expectRefused("git annex get 0.0.0");
}

TEST_F(ZarrRefusalTest, DamagedChunksAndBombsAreRefused) {
    const std::pair<std::string, Text> bombs[] = {
        {R"({"id": "zlib"})", zlibbed(Text(1 << 24, '\0'))},
        {R"({"id": "zstd"})", zstdOf(Text(1 << 24, '\0'))},
        {R"({"id": "lz4"})", lz4Of(Text(1 << 20, '\0'))},
        {R"({"id": "blosc"})", bloscOf(Text(1 << 21, '\0'), "lz4")}};
    for (const auto& [codec, bomb] : bombs) {
        SCOPED_TRACE(codec);
        put(".zarray", metadata2(codec));
        putChunks("", ".", [&chunk = bomb](const Text&) { return chunk; });
        expectRefused("data are damaged, or unpack to more than a chunk");
        putChunks("", ".",
                  [](const Text&) { return Text("\2\1\3\2rubbish that is none of them"); });
        expectRefused("data are damaged");
        putChunks("", ".",
                  [&chunk = bomb](const Text&) { return chunk.substr(0, chunk.size() / 2); });
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

TEST_F(ZarrRefusalTest, WhatIsNotReadIsRefusedByName) {
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

}  // namespace
}  // namespace adaptiso
