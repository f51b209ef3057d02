// Zarr and N5: metadata, a zero byte, a chunk. 2 x 3 x 4 samples, so that mutations hit headers.

#include <blosc.h>
#include <zstd.h>

#include "Seeds.h"
#include "Unit/ImageIO/Fixtures.h"

namespace adaptiso::fuzz {
namespace {

std::string samples() {
    return testing::samplesOf(testing::countingSamples<std::int16_t>(24));
}

std::string zstd(const std::string& bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
    return out;
}

std::string blosc(const std::string& bytes, const char* codec) {
    std::string out(bytes.size() + BLOSC_MAX_OVERHEAD, '\0');
    out.resize(static_cast<std::size_t>(blosc_compress_ctx(5, 1, 2, bytes.size(), bytes.data(),
                                                           out.data(), out.size(), codec, 0, 1)));
    return out;
}

void addVersion2(Seeds& seeds, const std::string& compressor, const std::string& chunk) {
    seeds.add("zarr", R"({"zarr_format":2,"shape":[2,3,5],"chunks":[2,3,4],"dtype":"<i2",)"
                      R"("order":"F","fill_value":-1,"filters":null,"dimension_separator":".",)"
                      R"("compressor":)" +
                          compressor + "}" + std::string(1, '\0') + chunk);
}

void addVersion3(Seeds& seeds, const std::string& codecs, const std::string& chunk) {
    seeds.add("zarr", R"({"zarr_format":3,"node_type":"array","shape":[2,3,5],"data_type":"int16",)"
                      R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[2,3,4]}},)"
                      R"("chunk_key_encoding":{"name":"default"},"fill_value":7,"codecs":[)" +
                          codecs + "]}" + std::string(1, '\0') + chunk);
}

std::string shard() {
    const std::string chunk = zstd(samples().substr(0, 24));
    std::string index = testing::bytesOf<std::uint64_t>(0) +
                        testing::bytesOf<std::uint64_t>(chunk.size()) + std::string(16, '\xff');
    return chunk + index;
}

void addN5(Seeds& seeds, const std::string& compression, const std::string& samples) {
    const std::string header("\0\0\0\3\0\0\0\4\0\0\0\3\0\0\0\2", 16);
    seeds.add("zarr",
              R"({"dimensions":[5,3,2],"blockSize":[4,3,2],"dataType":"int16",)"
              R"("pixelResolution":{"unit":"um","dimensions":[1,2,3]},"axes":["x","y","z"],)"
              R"("compression":{"type":")" +
                  compression + "\"}}" + std::string(1, '\0') + header + samples);
}

/// As lz4-java writes it, not packed.
std::string lz4Stream(const std::string& bytes) {
    const std::string size = testing::bytesOf(static_cast<std::uint32_t>(bytes.size()));
    return "LZ4Block\x16" + size + size + "sum." + bytes + "LZ4Block\x16" + std::string(12, '\0');
}

void addN5Seeds(Seeds& seeds) {
    addN5(seeds, "raw", samples());
    addN5(seeds, "gzip", testing::gzipped(samples()));
    addN5(seeds, "zstd", zstd(samples()));
    addN5(seeds, "blosc", blosc(samples(), "lz4"));
    addN5(seeds, "lz4", lz4Stream(samples()));
    for (const char* const way : {"downsamplingFactors", "scales"}) {
        seeds.add("zarr", R"({"pixelResolution":[1,2,3],")" + std::string(way) +
                              R"(":[[1,1,1],[2,2,1]]})" + std::string(1, '\0') +
                              std::string("\0\0\0\3\0\0\0\5\0\0\0\4\0\0\0\3", 16) +
                              std::string(60, 'x'));
    }
}

}  // namespace

void addZarrSeeds(Seeds& seeds) {
    addN5Seeds(seeds);
    addVersion2(seeds, "null", samples());
    addVersion2(seeds, R"({"id":"zlib"})", testing::zlibbed(samples()));
    addVersion2(seeds, R"({"id":"gzip"})", testing::gzipped(samples()));
    addVersion2(seeds, R"({"id":"zstd"})", zstd(samples()));
    addVersion2(seeds, R"({"id":"lz4"})",
                testing::bytesOf<std::uint32_t>(48) + "\xf0\x21" + samples());
    for (const char* const codec : {"lz4", "zstd", "zlib", "blosclz"}) {
        addVersion2(seeds, R"({"id":"blosc"})", blosc(samples(), codec));
    }
    addVersion3(seeds, R"({"name":"bytes","configuration":{"endian":"big"}})", samples());
    addVersion3(seeds,
                R"({"name":"transpose","configuration":{"order":[2,0,1]}},{"name":"bytes"},)"
                R"({"name":"zstd"},{"name":"crc32c"})",
                zstd(samples()) + "sum.");
    addVersion3(seeds,
                R"({"name":"sharding_indexed","configuration":{"chunk_shape":[2,3,2],)"
                R"("codecs":[{"name":"bytes"},{"name":"zstd"}],)"
                R"("index_codecs":[{"name":"bytes"}],"index_location":"end"}})",
                shard());
    const std::string multiscales =
        R"("multiscales":[{"version":"0.4","axes":[{"name":"z","type":"space","unit":"micrometer"},)"
        R"({"name":"y","type":"space","unit":"micrometer"},{"name":"x","type":"space"}],)"
        R"("datasets":[{"path":"0","coordinateTransformations":[{"type":"scale","scale":[3,2,1]},)"
        R"({"type":"translation","translation":[1,2,3]}]},{"path":"0"}]}])";
    seeds.add("zarr", "{" + multiscales + "}" + std::string(1, '\0') + std::string(60, 'x'));
    seeds.add("zarr", R"({"multiscales":[{"axes":[{"name":"z","type":"space","unit":" "},)"
                      R"({"name":"y","type":"space"},{"name":"x","type":"space","unit":"px"}],)"
                      R"("datasets":[{"path":"0"}]}]})" +
                          std::string(1, '\0') + std::string(60, 'x'));
    seeds.add("zarr",
              R"({"zarr_format":3,"node_type":"group","attributes":{"ome":{"version":"0.5",)" +
                  multiscales + "}}}" + std::string(1, '\0') + std::string(60, 'x'));
}

}  // namespace adaptiso::fuzz
