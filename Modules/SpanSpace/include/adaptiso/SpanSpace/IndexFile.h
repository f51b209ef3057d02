#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// An index as bytes that can be kept in a file, and back. Numbers are little-endian:
///
/// | byte | what |
/// |---|---|
/// | 0 | "ADAPTIDX" |
/// | 8 | format version, uint32: 2 |
/// | 12 | search, uint8: 0 kd-tree, 1 octree, 2 linear |
/// | 13 | border, uint8: 0 closed, 1 open |
/// | 14 | pixel type, uint8: 0 ... 9 for uint8, int8, uint16, int16, ... float32, float64 |
/// | 15 | block size, uint8 |
/// | 16 | samples along i, j, k, 3 x int64 |
/// | 40 | checksum of the samples, uint64 |
/// | 48 | minimum, then maximum of every node, in the pixel type; kd-tree: its block, uint32 |
/// | end - 8 | checksum of all bytes before, uint64 |
///
/// The kd-tree's nodes stand in tree order; for the others a node is a block, in block order. A
/// checksum is XXH64 [Collet2012] over the XXH64s of pieces of 1 MiB. Names, frames and dates are
/// not part of it.

/// \pre volume is what the index was built from; size and pixel type are checked
///      \throws InvalidInput otherwise
std::vector<std::byte> encodeIndex(const SpanSpaceIndex& index, const VolumeView& volume);

/// The index that encodeIndex() was given: as if it were built from `volume` anew.
///
/// Nothing in the bytes is trusted: their checksum, the volume's size, pixel type and samples, and
/// every node are checked, the minima and maxima against the volume's own and the tree's order
/// against them. So even bytes made up with the right checksums give the right index or none.
/// Messages call the bytes `name`: the file.
/// \throws InvalidInput  the bytes are no index, damaged, or of another volume
/// Cost: O(n) for n blocks, and two passes over the samples. Allocates in proportion to the
///       volume, whatever the bytes say.
SpanSpaceIndex decodeIndex(std::span<const std::byte> bytes, const VolumeView& volume,
                           const std::string& name = "decodeIndex");

/// Bytes that no index of the volume exceeds: a longer file need not be read.
std::uint64_t largestIndexBytes(const VolumeView& volume);

/// The checksum that the last eight bytes of an index hold of those before.
std::uint64_t indexChecksum(std::span<const std::byte> bytes);

}  // namespace adaptiso
