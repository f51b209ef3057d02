#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ZarrCodecs.h"
#include "ZarrScene.h"
#include "ZarrStore.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// An index, a size or a stride for each dimension of an array.
using ZarrIndex = std::vector<std::uint64_t>;

/// Codecs that turn the samples of a chunk into bytes.
struct ZarrEncoding {
    std::vector<std::size_t> order;  ///< dimensions of the array, the slowest first
    std::endian byteOrder = std::endian::little;
    std::vector<ZarrCodec> codecs{};
};

/// Chunks that are kept together in files of an index and inner chunks.
struct ZarrSharding {
    ZarrIndex shard;  ///< samples of a file
    std::endian indexOrder = std::endian::little;
    bool hasIndexSum = false;
    bool isIndexAtEnd = true;
};

/// Metadata of an array, of version 2 (.zarray) or 3 (zarr.json), or of N5.
struct ZarrArray {
    int version = 3;
    bool isN5 = false;  ///< each chunk has a header; keys name the fastest dimension first
    std::string path;   ///< in the store; empty: the root
    ZarrIndex shape, chunk;
    PixelType type{};
    std::array<std::byte, 8> fill{};  ///< a sample as it lies in memory
    ZarrEncoding encoding;
    std::optional<ZarrSharding> sharding{};
    bool hasKeyPrefix = false;              ///< "c/0/0/0"
    char separator = '/';                   ///< between the numbers of a chunk
    std::vector<std::string> dimensions{};  ///< names; empty: none are given

    std::size_t rank() const { return shape.size(); }
    /// Samples of a chunk, of an inner one where there are shards.
    std::uint64_t chunkSamples() const;
    std::string key(const ZarrIndex& file) const;
};

/// The samples that go by that name in Zarr 3 and N5. \param member  that names them
/// \throws FileError  any other
PixelType zarrTypeOf(const std::filesystem::path& file, const char* member,
                     const std::string& name);

/// \throws FileError  sizes are not of one rank, or a chunk is larger than what is read here
void requireZarrSizes(const std::filesystem::path& file, const ZarrArray& array);

/// Reads an array's metadata; none: there is no array at that path.
/// \throws FileError  they are damaged, or ask for what is not read here, by name
std::optional<ZarrArray> readZarrArray(const ZarrStore& store, const std::string& path);

/// The folder holds N5, Zarr's forerunner: an array, a group of one image in several resolutions
/// (s0, s1, ...), or a container of such. Files of that name (attributes.json) in folders of other
/// programs are let be, whatever is in them.
bool isN5Folder(const std::filesystem::path& folder);

/// An array's metadata, with its dimensions in Zarr's order, the slowest first; none: there is no
/// array of N5 at that path. Blocks that are not there hold 0.
/// \throws FileError  they are damaged, or ask for what is not read here, by name
std::optional<ZarrArray> readN5Array(const ZarrStore& store, const std::string& path);

/// The array at the root of a store, or one resolution of a group as n5-viewer, BigDataViewer and
/// neuroglancer have it: a voxel of a coarser one is the mean of those that it stands for, so that
/// its middle lies (factor - 1) / 2 of theirs further in. None: it holds neither.
/// \throws FileError  no such level, or its resolution is unknown
std::optional<ZarrScene> findN5Scene(const ZarrStore& store, std::int64_t level);

/// A block, with the header that says how large it is, as a chunk that is not cut off at the
/// array's end; what is beyond it is 0.
/// \param first  the block's first sample in the array
/// \throws FileError  the header contradicts the metadata; as unpackZarrChunk()
std::vector<std::byte> unpackN5Block(std::vector<std::byte> packed, const ZarrArray& array,
                                     const ZarrIndex& first, const std::filesystem::path& file);

}  // namespace adaptiso::detail
