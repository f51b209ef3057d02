#include "ZarrFolder.h"

#include <blosc.h>
#include <lz4.h>
#include <zstd.h>

#include <bit>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "ZarrCodecs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/ImageIO/ImageRegions.h"

namespace adaptiso::testing {
namespace fs = std::filesystem;

std::int16_t valueAt(int x, int y, int z) {
    return static_cast<std::int16_t>(100 * z + 10 * y + x - 300);
}

Text chunkAt(int cx, int cy, int cz, bool isF, bool isBig, int side) {
    Text text;
    for (int a = 0; a < side; ++a) {
        for (int b = 0; b < side; ++b) {
            for (int c = 0; c < side; ++c) {
                const int x = cx * side + (isF ? a : c), y = cy * side + b,
                          z = cz * side + (isF ? c : a);
                const bool isInside = x < kX && y < kY && z < kZ;
                text += bytesOf(isInside ? valueAt(x, y, z) : std::int16_t{7},
                                isBig ? std::endian::big : std::endian::little);
            }
        }
    }
    return text;
}

Text zstdOf(const Text& text) {
    Text out(ZSTD_compressBound(text.size()), '\0');
    out.resize(ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
    return out;
}

Text bloscOf(const Text& text, const char* inner) {
    Text out(text.size() + BLOSC_MAX_OVERHEAD, '\0');
    const int size =
        blosc_compress_ctx(5, 1, 2, text.size(), text.data(), out.data(), out.size(), inner, 0, 1);
    out.resize(static_cast<std::size_t>(size));
    return out;
}

Text lz4BlockOf(const Text& text) {
    Text out(static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(text.size()))), '\0');
    out.resize(static_cast<std::size_t>(LZ4_compress_default(
        text.data(), out.data(), static_cast<int>(text.size()), static_cast<int>(out.size()))));
    return out;
}

Text lz4Of(const Text& text) {
    return bytesOf(static_cast<std::uint32_t>(text.size())) + lz4BlockOf(text);
}

Text withSum(const Text& text) {
    return text + bytesOf(detail::crc32c(std::as_bytes(std::span(text.data(), text.size()))));
}

Text same(const Text& text) {
    return text;
}

void ZarrFolder::SetUp() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::path(::testing::TempDir()) / ("Zarr-" + std::string(test->name()));
    fs::remove_all(root_);
}

void ZarrFolder::put(const std::string& key, const Text& text) const {
    fs::create_directories((root_ / key).parent_path());
    std::ofstream(root_ / key, std::ios::binary) << text;
}

Text withLastOfKeys(const Text& text) {
    using Json = nlohmann::json;
    if (isDeeplyNested(text) || !parseJson<Json>(text).is_discarded()) return text;
    const Json json = Json::parse(text, nullptr, false);
    return json.is_discarded() ? text : json.dump();
}

Text ZarrFolder::metadata2(const std::string& compressor, const std::string& more,
                           const std::string& dtype, const std::string& order) {
    return withLastOfKeys(
        R"({"zarr_format": 2, "shape": [5, 6, 7], "chunks": [4, 4, 4], "dtype": ")" + dtype +
        R"(", "order": ")" + order + R"(", "fill_value": -9, "filters": null, )" +
        R"("compressor": )" + compressor + more + "}");
}

Text ZarrFolder::metadata3(const std::string& codecs, const std::string& more) {
    return withLastOfKeys(
        R"({"zarr_format": 3, "node_type": "array", "shape": [5, 6, 7],
               "data_type": "int16", "fill_value": -9,
               "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [4, 4, 4]}},
               "chunk_key_encoding": {"name": "default"}, "codecs": )" +
        codecs + more + "}");
}

void ZarrFolder::putChunks(const std::string& prefix, const std::string& separator,
                           const std::function<Text(const Text&)>& pack, bool isF,
                           bool isBig) const {
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

void ZarrFolder::expectValues(const ReadVolume& read, const fs::path& folder,
                              const ReadOptions& options) {
    const TypedVolumeView<std::int16_t> view = read.volume.view().as<std::int16_t>();
    ASSERT_EQ(view.geometry.size, (Index3{kX, kY, kZ}));
    for (int z = 0; z < kZ; ++z) {
        for (int y = 0; y < kY; ++y) {
            for (int x = 0; x < kX; ++x) ASSERT_EQ(view.at(x, y, z), valueAt(x, y, z));
        }
    }
    expectParts(folder, options);
}

void ZarrFolder::expectParts(const fs::path& folder, const ReadOptions& options) {
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

void ZarrFolder::expectRefused(const std::string& reason, const ReadOptions& options) const {
    try {
        readVolume(root_, options);
        FAIL() << "was read; should say: " << reason;
    } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

}  // namespace adaptiso::testing
