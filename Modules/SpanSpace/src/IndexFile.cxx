#include "adaptiso/SpanSpace/IndexFile.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "Checksum.h"
#include "SpanSpaceIndexImpl.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

constexpr std::array<char, 8> kMagic{'A', 'D', 'A', 'P', 'T', 'I', 'D', 'X'};
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHeaderBytes = 48;
constexpr std::size_t kChecksumBytes = sizeof(std::uint64_t);

// what the header's numbers stand for: part of the format, so not the order of the enumerations
constexpr std::array kSearches{BlockSearchKind::KdTree, BlockSearchKind::Octree,
                               BlockSearchKind::Linear};
constexpr std::array kBorders{Border::Closed, Border::Open};
constexpr std::array kBlockSizes{2, 4, 8, 16};
constexpr std::array kPixelTypes{
    PixelType::UInt8, PixelType::Int8,   PixelType::UInt16, PixelType::Int16,   PixelType::UInt32,
    PixelType::Int32, PixelType::UInt64, PixelType::Int64,  PixelType::Float32, PixelType::Float64};

template <class Values, class Value>
std::uint8_t codeOf(const Values& values, Value value) {
    return static_cast<std::uint8_t>(std::find(values.begin(), values.end(), value) -
                                     values.begin());
}

/// The first 48 bytes, as they stand in the file.
struct Header {
    std::array<char, 8> magic;
    std::uint32_t version;
    std::uint8_t search, border, pixelType, blockSize;
    Index3 volumeSize;
    std::uint64_t samples;
};
static_assert(sizeof(Header) == kHeaderBytes && std::is_trivially_copyable_v<Header>);

std::uint64_t checksumOfSamples(const VolumeView& volume) {
    return detail::checksumOf(
        {static_cast<const std::byte*>(volume.samples()), volume.byteCount()});
}

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
    throw InvalidInput(name + ": " + why);
}

std::string describe(const Index3& size, PixelType type) {
    return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
           std::to_string(size[2]) + " samples of " + std::string(toString(type));
}

/// What can be told from the bytes alone.
Header checkedHeader(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() < kMagic.size() ||
        std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
        refuse(name, "is not an index of adaptiso");
    }
    if (bytes.size() < kHeaderBytes + kChecksumBytes) refuse(name, "the index is cut off");
    Header header{};
    std::memcpy(&header, bytes.data(), kHeaderBytes);
    if (header.version != kVersion) {
        refuse(name, "is an index of format version " + std::to_string(header.version) +
                         "; this program reads version " + std::to_string(kVersion));
    }
    std::uint64_t checksum = 0;
    const auto content = bytes.first(bytes.size() - kChecksumBytes);
    std::memcpy(&checksum, bytes.data() + content.size(), kChecksumBytes);
    if (checksum != indexChecksum(content)) {
        refuse(name, "the index is cut off or damaged (its checksum is wrong)");
    }
    if (header.search >= kSearches.size() || header.border >= kBorders.size() ||
        header.pixelType >= kPixelTypes.size() ||
        std::find(kBlockSizes.begin(), kBlockSizes.end(), header.blockSize) == kBlockSizes.end()) {
        refuse(name, "the index is damaged (its header holds a number that means nothing)");
    }
    return header;
}

void checkVolume(const Header& header, const VolumeView& volume, const std::string& name) {
    const PixelType type = kPixelTypes[header.pixelType];
    if (header.volumeSize != volume.geometry().size || type != volume.pixelType()) {
        refuse(name, "is the index of another image, of " + describe(header.volumeSize, type) +
                         "; this one has " + describe(volume.geometry().size, volume.pixelType()));
    }
    if (header.samples != checksumOfSamples(volume)) {
        refuse(name, "is the index of another image of the same size (the samples differ)");
    }
}

/// Takes arrays off the front of a payload. \pre they are there
class Payload {
public:
    explicit Payload(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <class T>
    std::vector<T> take(std::int64_t count) {
        std::vector<T> values(count);
        std::memcpy(values.data(), bytes_.data(), values.size() * sizeof(T));
        bytes_ = bytes_.subspan(values.size() * sizeof(T));
        return values;
    }

private:
    std::span<const std::byte> bytes_;
};

/// Null when the payload is not that of these ranges.
template <class T>
std::unique_ptr<const detail::BlockSearch<T>> restoredSearch(std::span<const std::byte> bytes,
                                                             const BlockGrid& grid,
                                                             BlockSearchKind kind,
                                                             detail::BlockRanges<T> ranges) {
    Payload payload(bytes);
    detail::BlockRanges<T> kept;
    kept.minimum = payload.take<T>(grid.blockCount());
    kept.maximum = payload.take<T>(grid.blockCount());
    if (kind == BlockSearchKind::KdTree) {
        return detail::SpanTree<T>::restored(
            std::move(kept), payload.take<std::uint32_t>(grid.blockCount()), ranges);
    }
    if (kept.minimum != ranges.minimum || kept.maximum != ranges.maximum) return nullptr;
    return detail::makeSearch<T>(std::move(ranges), grid, kind);
}

std::size_t payloadBytes(const BlockGrid& grid, BlockSearchKind kind, PixelType type) {
    const std::size_t extra = kind == BlockSearchKind::KdTree ? sizeof(std::uint32_t) : 0;
    return static_cast<std::size_t>(grid.blockCount()) * (2 * bytesPerPixel(type) + extra);
}

}  // namespace

std::uint64_t indexChecksum(std::span<const std::byte> bytes) {
    return detail::checksumOf(bytes);
}

std::uint64_t largestIndexBytes(const VolumeView& volume) {
    std::uint64_t blocks = 1;  // of the smallest blocks, with a closed border
    for (const std::int64_t extent : volume.geometry().size) {
        blocks *= static_cast<std::uint64_t>(extent) / 2 + 2;
    }
    return kHeaderBytes + kChecksumBytes +
           blocks * (2 * bytesPerPixel(volume.pixelType()) + sizeof(std::uint32_t));
}

std::vector<std::byte> encodeIndex(const SpanSpaceIndex& index, const VolumeView& volume) {
    const BlockGrid& grid = index.grid();
    if (grid.volumeSize != volume.geometry().size || index.pixelType() != volume.pixelType()) {
        throw InvalidInput("encodeIndex: the index was built from another volume");
    }
    const Header header{kMagic,
                        kVersion,
                        codeOf(kSearches, index.search()),
                        codeOf(kBorders, grid.border),
                        codeOf(kPixelTypes, index.pixelType()),
                        static_cast<std::uint8_t>(grid.blockSize),
                        grid.volumeSize,
                        checksumOfSamples(volume)};
    std::vector<std::byte> bytes;
    bytes.reserve(kHeaderBytes + payloadBytes(grid, index.search(), index.pixelType()) +
                  kChecksumBytes);
    const auto append = [&](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
    };
    append(std::as_bytes(std::span(&header, 1)));
    std::visit(
        [&](const auto& search) {
            for (const auto array : search->arrays()) append(array);
        },
        index.impl_->search);
    const std::uint64_t checksum = indexChecksum(bytes);
    append(std::as_bytes(std::span(&checksum, 1)));
    return bytes;
}

SpanSpaceIndex decodeIndex(std::span<const std::byte> bytes, const VolumeView& volume,
                           const std::string& name) {
    const Header header = checkedHeader(bytes, name);
    checkVolume(header, volume, name);
    const BlockSearchKind kind = kSearches[header.search];
    // from here on lengths follow from the volume
    const BlockGrid grid =
        BlockGrid::make(volume.geometry().size, header.blockSize, kBorders[header.border]);
    const auto payload = bytes.subspan(kHeaderBytes, bytes.size() - kHeaderBytes - kChecksumBytes);
    if (payload.size() != payloadBytes(grid, kind, volume.pixelType())) {
        refuse(name, "the index is damaged (its length is wrong)");
    }
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        auto search =
            restoredSearch<T>(payload, grid, kind, detail::computeBlockRanges(view, grid));
        if (!search) refuse(name, "the index is damaged (it does not fit the image)");
        return SpanSpaceIndex(std::make_unique<SpanSpaceIndex::Impl>(
            SpanSpaceIndex::Impl{grid, volume.pixelType(), kind, std::move(search)}));
    });
}

}  // namespace adaptiso
