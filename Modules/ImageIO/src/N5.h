#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ZarrArray.h"
#include "ZarrScene.h"
#include "ZarrStore.h"

namespace adaptiso::detail {

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
