#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "Bytes.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

// FIFF, the tagged file of Neuromag and MNE: big-endian tags of kind, type, size, next, data. What
// is here is what surfaces and digitized points take.
namespace adaptiso::meshio::fiff {

// kinds of tags
inline constexpr std::int32_t kFileId = 100, kDirectoryPointer = 101, kBlockStart = 104,
                              kBlockEnd = 105, kFreeList = 106, kNop = 108;
inline constexpr std::int32_t kChannelInfo = 203, kDigPoint = 213, kCoordTrans = 222,
                              kDigString = 234;
inline constexpr std::int32_t kSurfaceId = 3101, kNodeCount = 3103, kTriangleCount = 3104,
                              kNodes = 3105, kTriangles = 3106, kNormals = 3107,
                              kBemCoordFrame = 3112, kSigma = 3113, kMneCoordFrame = 3506,
                              kMneChannelNames = 3507;
// of sources, and of the image that a grid of them lies in
inline constexpr std::int32_t kSourcePoints = 3510, kSourceNormals = 3511, kSourcePointCount = 3512,
                              kSourceSelection = 3513, kSourcesUsed = 3514, kSourceId = 3517,
                              kSourceType = 3518, kSourceTriangleCount = 3590,
                              kSourceTriangles = 3591, kSourceGridSize = 3596, kMriWidth = 2010,
                              kMriHeight = 2012, kMriDepth = 2014;
// kinds of blocks
inline constexpr std::int32_t kIsotrak = 107, kBem = 310, kBemSurface = 311, kMne = 350,
                              kMneSources = 351, kMneParentMri = 353;
// coordinate frames
inline constexpr std::int32_t kFrameHead = 4, kFrameMri = 5, kFrameMriVoxel = 2001,
                              kFrameRas = 2002;

/// First bytes of a file: the tag FILE_ID of 20 bytes.
inline constexpr std::string_view kMagic("\0\0\0\x64\0\0\0\x1F\0\0\0\x14", 12);

/// One tag of a file.
struct Tag {
    std::int32_t kind = 0;
    std::uint32_t type = 0;
    std::string_view data;
    std::size_t block = 0;  ///< number of the innermost block it stands in; 0: in none
};

struct Block {
    std::int32_t kind = 0;  ///< 0: the file itself
    std::size_t parent = 0;
};

/// The tags of a file, in its order. Blocks are numbered as they begin, the file itself is 0.
struct Content {
    std::vector<Tag> tags;
    std::vector<Block> blocks;
    std::string_view behind;  ///< bytes after the last tag

    /// The first tag of this kind that stands in this block itself.
    const Tag* find(std::size_t block, std::int32_t kind) const;
};

/// Reads tags one after the other. Damage where the bytes are no FIFF file, or end within a tag,
/// or blocks end that did not begin. \pre bytes outlive what is returned
Content decode(std::string_view bytes);

std::int32_t toInt(const Tag& tag);
float toReal(const Tag& tag);
/// Rows of three of a dense matrix (dimensions behind the data, the last one first).
std::vector<Vec3> toVectors(const Tag& tag);
std::vector<std::array<std::int32_t, 3>> toTriples(const Tag& tag);

/// Integers of a list.
std::vector<std::int32_t> toInts(const Tag& tag);
/// Reads a transform of putTransform(); the inverse behind it is passed over.
AffineTransform toTransform(const Tag& tag);

/// A point of a digitizer.
struct DigitizedPoint {
    std::int32_t kind = 0;  ///< 1 cardinal, 2 HPI, 3 EEG, 4 extra
    std::int32_t number = 0;
    Vec3 metres;
};
DigitizedPoint toPoint(const Tag& tag);

/// A channel of measured data.
struct Channel {
    std::int32_t kind = 0;  ///< 2 EEG
    Vec3 metres;            ///< of its electrode
    std::string_view name;
};
Channel toChannel(const Tag& tag);

/// Writes a file tag by tag. No date, machine or user is in it.
class Writer {
public:
    explicit Writer(ByteSink& sink);

    void begin(std::int32_t block) { put(kBlockStart, block); }
    void end(std::int32_t block) { put(kBlockEnd, block); }
    void put(std::int32_t kind, std::int32_t value);
    void put(std::int32_t kind, float value);
    void put(std::int32_t kind, std::string_view text);
    void put(std::int32_t kind, std::span<const std::int32_t> values);
    void put(std::int32_t kind, std::span<const Vec3> rows);
    void put(std::int32_t kind, std::span<const std::array<std::int32_t, 3>> rows);
    /// A point of a digitizer: Isotrak's kind (1 cardinal, 3 EEG, 4 extra), its number, metres.
    void putPoint(std::int32_t pointKind, std::int32_t number, const Vec3& metres);
    /// From one coordinate frame to another, with its inverse. \param metres  offset in metres
    void putTransform(std::int32_t from, std::int32_t to, const AffineTransform& metres);
    /// The last tag of a file.
    void finish();

private:
    void header(std::int32_t kind, std::uint32_t type, std::size_t bytes, std::int32_t next = 0);

    ByteSink& sink_;
};

}  // namespace adaptiso::meshio::fiff
