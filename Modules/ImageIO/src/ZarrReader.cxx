#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstring>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "FileFault.h"
#include "Readers.h"
#include "Samples.h"
#include "ZarrArray.h"
#include "ZarrImage.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Surplus.h"

// Zarr's specifications 2 and 3 with sharding, OME-NGFF 0.4 and 0.5, N5.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// The index asked for in a dimension other than x, y and z.
std::uint64_t chosenIndex(const fs::path& root, const ZarrAxis& axis, std::uint64_t extent,
                          const ReadOptions& options) {
    const bool isChannel = axis.kind == ZarrAxis::Kind::Channel;
    const bool isTime = axis.kind == ZarrAxis::Kind::Time;
    const std::optional<std::int64_t> wanted = isChannel ? options.channel
                                               : isTime  ? options.timePoint
                                                         : options.volumeIndex;
    const char* const option = isChannel ? "--channel" : isTime ? "--time" : "--volume-index";
    const char* const what = isChannel ? "channel" : isTime ? "time point" : "volume";
    const bool isVolume = !isChannel && !isTime;
    if (!wanted && extent == 1) return 0;
    if (!wanted || *wanted < 0 || static_cast<std::uint64_t>(*wanted) >= extent) {
        const std::string fault =
            wanted ? fmt::format("there is no {} {}: it holds {}", what, *wanted, extent)
                   : fmt::format("holds {} {}s", extent, what);
        const std::string remedy = fmt::format("choose one, 0 to {} ({})", extent - 1, option);
        if (!isVolume) refuse(root, fault, remedy);
        refuseChoice(root, fault, remedy, ChoiceNeeded::Among::Volumes,
                     static_cast<std::int64_t>(extent));
    }
    return static_cast<std::uint64_t>(*wanted);
}

/// The dimension that is called x, y or z, or the place that it has by custom.
std::array<std::size_t, 3> spaceOf(const fs::path& root, const ZarrArray& array,
                                   const ZarrScene& scene) {
    std::vector<std::size_t> found;
    std::vector<std::string> names;
    for (std::size_t n = 0; n < array.rank(); ++n) {
        if (!scene.axes.empty() && scene.axes[n].kind != ZarrAxis::Kind::Space) continue;
        if (scene.axes.empty() && n + 3 < array.rank()) continue;
        found.push_back(n);
        names.push_back(!scene.axes.empty()        ? scene.axes[n].name
                        : array.dimensions.empty() ? std::string()
                                                   : array.dimensions[n]);
    }
    if (found.size() != 3) {
        refuse(root, fmt::format("is an image of {} dimensions in space", found.size()),
               "a surface needs three");
    }
    std::array<std::size_t, 3> space{found[2], found[1], found[0]};  // the fastest is x
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto named = std::find(names.begin(), names.end(), std::string(1, "xyz"[axis]));
        if (named == names.end()) return {found[2], found[1], found[0]};
        space[axis] = found[static_cast<std::size_t>(named - names.begin())];
    }
    return space;
}

/// An index that was asked for in a dimension that the array has not: it has one thing of it.
void requireAxis(const fs::path& root, const std::optional<std::int64_t>& wanted, bool isThere,
                 const char* what, const char* option) {
    if (!wanted || isThere || *wanted == 0) return;
    refuse(root, fmt::format("there is no {} {}: it has no such axis", what, *wanted),
           fmt::format("leave {} out", option));
}

ZarrCut cutOf(const fs::path& root, const ZarrArray& array, const ZarrScene& scene,
              const ReadOptions& options) {
    if (!scene.axes.empty() && scene.axes.size() != array.rank()) {
        refuse(root,
               fmt::format("its metadata contradict each other: {} axes, {} dimensions",
                           scene.axes.size(), array.rank()),
               "repair them");
    }
    ZarrCut cut{spaceOf(root, array, scene), ZarrIndex(array.rank(), 0)};
    bool hasChannels = false, hasTimes = false, hasOthers = false;
    for (std::size_t n = 0; n < array.rank(); ++n) {
        if (cut.isSpace(n)) continue;
        const ZarrAxis axis = scene.axes.empty() ? ZarrAxis{} : scene.axes[n];
        const bool isChannel = axis.kind == ZarrAxis::Kind::Channel,
                   isTime = axis.kind == ZarrAxis::Kind::Time;
        hasChannels = hasChannels || isChannel;
        hasTimes = hasTimes || isTime;
        hasOthers = hasOthers || !(isChannel || isTime);
        cut.fixed[n] = chosenIndex(root, axis, array.shape[n], options);
    }
    requireAxis(root, options.channel, hasChannels, "channel", "--channel");
    requireAxis(root, options.timePoint, hasTimes, "time point", "--time");
    requireAxis(root, options.volumeIndex, hasOthers, "volume", "--volume-index");
    return cut;
}

ImageGeometry geometryOf(const fs::path& root, const ZarrArray& array, const ZarrCut& cut,
                         std::optional<ImageSpace> given, ZarrScene& scene) {
    ImageGeometry geometry;
    geometry.indexToPhysical = Mat3::diagonal(1, 1, 1);
    bool hasUnits = true, hasUnit = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t n = cut.space[axis];
        geometry.size[axis] = static_cast<std::int64_t>(array.shape[n]);
        if (scene.axes.empty()) continue;
        hasUnits = hasUnits && scene.axes[n].toMm.has_value();
        hasUnit = hasUnit || scene.axes[n].toMm.has_value();
        const double toMm = scene.axes[n].toMm.value_or(1);
        const auto of = static_cast<int>(axis);
        geometry.indexToPhysical.column[of][of] = toMm * scene.scale[n];
        geometry.originMm[of] = toMm * scene.shift[n];
    }
    if (scene.axes.empty()) {
        scene.warnings.push_back({"guessed-spacing",
                                  "an array says neither the size of its voxels nor where "
                                  "they lie; 1 mm was taken"});
    } else if (!scene.saysScale) {
        scene.warnings.push_back(
            {"guessed-spacing",
             "it does not say the size of its voxels (a scale); a scale of 1 was taken"});
    }
    if (!scene.axes.empty() && !hasUnits && hasUnit) {
        refuse(root, "some of its axes in space have a unit, others none", "repair the metadata");
    } else if (!scene.axes.empty() && !hasUnits) {
        scene.warnings.push_back({"guessed-unit", "its axes have no unit; millimetres were taken"});
    }
    if (!given) {
        scene.warnings.push_back(
            {"guessed-orientation",
             "the format names no anatomical directions: x, y and z were taken "
             "for LPS (--image-space chooses)"});
    }
    const Mat3 toLps = detail::toLps(given.value_or(ImageSpace::Lps));
    geometry.indexToPhysical = toLps * geometry.indexToPhysical;
    geometry.originMm = toLps * geometry.originMm;
    return geometry;
}

/// The files of an array, shards or chunks, that a part of the image touches: those of x the
/// fastest.
class TouchedFiles {
public:
    TouchedFiles(const ZarrArray& array, const ZarrCut& cut, const ZarrRegion& region)
        : array_(array), cut_(cut), side_(array.sharding ? array.sharding->shard : array.chunk) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::uint64_t side = side_[cut.space[axis]];
            const auto first = static_cast<std::uint64_t>(region.first[axis]),
                       size = static_cast<std::uint64_t>(region.size[axis]);
            first_[axis] = first / side;
            count_[axis] = (first + size - 1) / side - first_[axis] + 1;
        }
    }

    /// Along each axis.
    const std::array<std::uint64_t, 3>& counts() const { return count_; }

    /// The place of a file among the array's.
    ZarrIndex indexOf(std::uint64_t number) const {
        ZarrIndex index(array_.rank());
        for (std::size_t n = 0; n < array_.rank(); ++n) index[n] = cut_.fixed[n] / side_[n];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            index[cut_.space[axis]] = first_[axis] + number % count_[axis];
            number /= count_[axis];
        }
        return index;
    }
    const ZarrIndex& side() const { return side_; }

private:
    const ZarrArray& array_;
    const ZarrCut& cut_;
    const ZarrIndex side_;  ///< of a file, samples
    std::array<std::uint64_t, 3> first_{}, count_{};
};

/// Copies the samples of chunks to where they lie in the part of the image.
class Assembly {
public:
    Assembly(const ZarrImage& image, const ZarrRegion& region, std::byte* out)
        : store_(image.store),
          array_(image.array),
          cut_(image.cut),
          region_(region),
          touched_(array_, cut_, region),
          out_(out),
          sampleBytes_(bytesPerPixel(array_.type)),
          isWhole_(region.size == image.geometry.size),
          strides_(array_.rank()) {
        std::uint64_t stride = 1;
        for (std::size_t n = array_.rank(); n-- > 0;) {
            strides_[array_.encoding.order[n]] = stride;
            stride *= array_.chunk[array_.encoding.order[n]];
        }
    }

    /// Files that hold chunks, along each axis.
    const std::array<std::uint64_t, 3>& files() const { return touched_.counts(); }
    std::int64_t missing() const { return missing_; }
    std::int64_t chunks() const { return chunks_; }
    /// Chunks hold more than one value beyond the array's shape; false for a part of the image.
    bool hasMoreBeyond() const { return hasMoreBeyond_; }

    /// \throws FileError  a chunk that is there can't be read, is damaged, too short or too long
    void addFile(std::uint64_t number) {
        const ZarrIndex& side = touched_.side();
        ZarrIndex index = touched_.indexOf(number);
        const std::optional<ZarrFile> file = store_.open(array_.key(index));
        for (std::size_t n = 0; n < array_.rank(); ++n) index[n] *= side[n];  // first sample
        try {
            if (array_.sharding) {
                addShard(file, index);
            } else {
                ++chunks_;
                addChunk(file, 0, file ? file->size() : 0, index);
            }
        } catch (const FileError&) {
            const auto foreign = file ? findForeignContent(file->path()) : std::nullopt;
            // packed data are what chunks hold
            if (!foreign || foreign->kind != ForeignKind::StandIn) throw;
            refuse(file->path(), foreign->fault, foreign->remedy);
        }
    }

private:
    using Bytes = std::vector<std::byte>;

    std::uint64_t chunkBytes() const { return array_.chunkSamples() * sampleBytes_; }

    /// A chunk from its file, or the fill value if missing.
    void addChunk(const std::optional<ZarrFile>& file, std::uint64_t offset, std::uint64_t size,
                  const ZarrIndex& first) {
        if (!file) {
            ++missing_;
            place(nullptr, first, array_.chunk);
            return;
        }
        const Bytes samples = readChunk(*file, offset, size, first);
        lookBeyond(samples.data(), first);
        place(samples.data(), first, array_.chunk);
    }

    /// The samples of a chunk that is there.
    Bytes readChunk(const ZarrFile& file, std::uint64_t offset, std::uint64_t size,
                    const ZarrIndex& first) const {
        if (size > zarrPackedLimit(chunkBytes())) {
            refuse(
                file.path(),
                fmt::format("holds {} bytes, more than a chunk of {} can take", size, chunkBytes()),
                "get the dataset again");
        }
        Bytes bytes(static_cast<std::size_t>(size));
        file.read(offset, bytes.data(), bytes.size());
        bytes = array_.isN5 ? unpackN5Block(std::move(bytes), array_, first, file.path())
                            : unpackZarrChunk(std::move(bytes), array_.encoding.codecs,
                                              chunkBytes(), file.path());
        if (array_.encoding.byteOrder != std::endian::native) {
            swapBytes(bytes.data(), bytes.size(), sampleBytes_);
        }
        return bytes;
    }

    /// Writers pad chunks at the image's end with one value.
    void lookBeyond(const std::byte* samples, const ZarrIndex& first) {
        bool isAtEnd = false;
        for (std::size_t n = 0; n < array_.rank(); ++n) {
            isAtEnd = isAtEnd || first[n] + array_.chunk[n] > array_.shape[n];
        }
        if (!isAtEnd || !isWhole_ || hasMoreBeyond_) return;
        const std::size_t row = array_.encoding.order.back();  // its samples are side by side
        const std::uint64_t length = array_.chunk[row],
                            inside = array_.shape[row] - std::min(array_.shape[row], first[row]);
        const std::byte* one = nullptr;
        ZarrIndex at(array_.rank(), 0);
        for (std::uint64_t rows = array_.chunkSamples() / length; rows > 0; --rows) {
            bool isBeyond = false;
            const std::byte* from = samples;
            for (std::size_t n = 0; n < array_.rank(); ++n) {
                isBeyond = isBeyond || first[n] + at[n] >= array_.shape[n];
                from += at[n] * strides_[n] * sampleBytes_;
            }
            for (std::uint64_t x = isBeyond ? 0 : std::min(inside, length); x < length; ++x) {
                if (one == nullptr) one = from + x * sampleBytes_;
                if (std::memcmp(one, from + x * sampleBytes_, sampleBytes_) == 0) continue;
                hasMoreBeyond_ = true;
                return;
            }
            for (std::size_t n = array_.rank(); n-- > 0;) {
                if (n == row) continue;
                if (++at[n] < array_.chunk[n]) break;
                at[n] = 0;
            }
        }
    }

    /// Inner chunks in the order of their numbers, the last dimension the fastest.
    void addShard(const std::optional<ZarrFile>& file, const ZarrIndex& first) {
        const ZarrSharding& sharding = *array_.sharding;
        if (!file) return addMissingShard(first);
        ZarrIndex counts(array_.rank());
        std::uint64_t count = 1;
        for (std::size_t n = 0; n < array_.rank(); ++n) {
            counts[n] = sharding.shard[n] / array_.chunk[n];
            count = requireProduct(store_.root(), count, counts[n]);
        }
        const std::vector<std::uint64_t> index = readIndex(*file, count);
        ZarrIndex inner(array_.rank(), 0);
        for (std::uint64_t number = 0; number < count; ++number) {
            addInner(file, index, number, first, inner);
            for (std::size_t n = array_.rank(); n-- > 0 && ++inner[n] == counts[n];) inner[n] = 0;
        }
    }

    /// Filled at once, however large its metadata claim it to be.
    void addMissingShard(const ZarrIndex& first) {
        std::int64_t count = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t n = cut_.space[axis];
            const auto [begin, end] = within(axis, first, array_.sharding->shard);
            const std::uint64_t side = array_.chunk[n];
            count *= static_cast<std::int64_t>((end - 1) / side - begin / side + 1);
        }
        chunks_ += count;
        missing_ += count;
        place(nullptr, first, array_.sharding->shard);
    }

    void addInner(const std::optional<ZarrFile>& file, const std::vector<std::uint64_t>& index,
                  std::uint64_t number, const ZarrIndex& first, const ZarrIndex& inner) {
        ZarrIndex at(array_.rank());
        for (std::size_t n = 0; n < array_.rank(); ++n) {
            at[n] = first[n] + inner[n] * array_.chunk[n];
            if (!cut_.isSpace(n) && cut_.fixed[n] / array_.chunk[n] != at[n] / array_.chunk[n]) {
                return;
            }
        }
        bool isInPart = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [begin, end] = within(axis, at, array_.chunk);
            isInPart = isInPart && begin < end;
        }
        // of the whole image, those that are in no part of it lie beyond its shape
        if (!isInPart && (!isWhole_ || hasMoreBeyond_)) return;
        chunks_ += isInPart ? 1 : 0;
        constexpr std::uint64_t kNone = ~std::uint64_t{0};
        const bool isThere = !(index[2 * number] == kNone && index[2 * number + 1] == kNone);
        if (!isThere) {
            if (isInPart) addChunk(std::nullopt, 0, 0, at);
            return;
        }
        const std::uint64_t offset = index[2 * number], size = index[2 * number + 1];
        if (offset > file->size() || size > file->size() - offset) {
            refuse(file->path(), "is damaged: its index leads out of it", "get the dataset again");
        }
        if (isInPart) return addChunk(file, offset, size, at);
        lookBeyond(readChunk(*file, offset, size, at).data(), at);
    }

    /// Offset and size of each inner chunk.
    std::vector<std::uint64_t> readIndex(const ZarrFile& file, std::uint64_t count) const {
        const ZarrSharding& sharding = *array_.sharding;
        constexpr std::uint64_t kEntry = 16, kSum = 4;
        const std::uint64_t sumBytes = sharding.hasIndexSum ? kSum : 0;
        if (count > file.size() / kEntry || count * kEntry + sumBytes > file.size()) {
            refuse(file.path(), "is too short for the index of its chunks",
                   "get the dataset again");
        }
        Bytes bytes(static_cast<std::size_t>(count * kEntry + sumBytes));
        file.read(sharding.isIndexAtEnd ? file.size() - bytes.size() : 0, bytes.data(),
                  bytes.size());
        if (sharding.hasIndexSum) {
            const std::array<ZarrCodec, 1> sum{ZarrCodec::Crc32c};
            bytes = unpackZarrChunk(std::move(bytes), sum, count * kEntry, file.path());
        }
        if (sharding.indexOrder != std::endian::native) {
            swapBytes(bytes.data(), bytes.size(), sizeof(std::uint64_t));
        }
        std::vector<std::uint64_t> index(static_cast<std::size_t>(2 * count));
        std::memcpy(index.data(), bytes.data(), bytes.size());
        return index;
    }

    /// The samples of a chunk or a shard that lie in the part, along an axis: from begin to end.
    std::pair<std::uint64_t, std::uint64_t> within(std::size_t axis, const ZarrIndex& first,
                                                   const ZarrIndex& side) const {
        const std::size_t n = cut_.space[axis];
        const auto begin = static_cast<std::uint64_t>(region_.first[axis]),
                   end = begin + static_cast<std::uint64_t>(region_.size[axis]);
        return {std::max(first[n], begin), std::min(first[n] + side[n], end)};
    }

    /// Copies what of a chunk lies in the part. \param samples  nullptr: the fill value
    void place(const std::byte* samples, const ZarrIndex& first, const ZarrIndex& side) {
        std::array<std::uint64_t, 3> begin{}, count{}, size{}, step{};
        std::uint64_t base = 0;
        for (std::size_t n = 0; n < array_.rank(); ++n) {
            if (samples != nullptr && !cut_.isSpace(n)) {
                base += (cut_.fixed[n] - first[n]) * strides_[n];
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t n = cut_.space[axis];
            const auto [low, high] = within(axis, first, side);
            size[axis] = static_cast<std::uint64_t>(region_.size[axis]);
            begin[axis] = low - static_cast<std::uint64_t>(region_.first[axis]);
            count[axis] = high - low;
            step[axis] = strides_[n];
            if (samples != nullptr) base += (low - first[n]) * strides_[n];
        }
        const auto outAt = [&](std::uint64_t y, std::uint64_t z) {
            const std::uint64_t at = ((begin[2] + z) * size[1] + begin[1] + y) * size[0] + begin[0];
            return out_ + at * sampleBytes_;
        };
        const bool isWhole = count[0] == size[0] && count[1] == size[1];
        if (samples == nullptr && isWhole) return fill(outAt(0, 0), count[0] * count[1] * count[2]);
        for (std::uint64_t z = 0; z < count[2]; ++z) {
            for (std::uint64_t y = 0; y < count[1]; ++y) {
                if (samples == nullptr) {
                    fill(outAt(y, z), count[0]);
                } else {
                    const std::uint64_t from = base + z * step[2] + y * step[1];
                    placeRow(samples, from, step[0], outAt(y, z), count[0]);
                }
            }
        }
    }

    void placeRow(const std::byte* samples, std::uint64_t from, std::uint64_t step, std::byte* to,
                  std::uint64_t count) const {
        if (step == 1) {
            std::memcpy(to, samples + from * sampleBytes_, count * sampleBytes_);
            return;
        }
        for (std::uint64_t x = 0; x < count; ++x) {
            std::memcpy(to + x * sampleBytes_, samples + (from + x * step) * sampleBytes_,
                        sampleBytes_);
        }
    }

    /// The fill value, once and then what is there again and again.
    void fill(std::byte* to, std::uint64_t count) const {
        const std::uint64_t bytes = count * sampleBytes_;
        std::memcpy(to, array_.fill.data(), sampleBytes_);
        for (std::uint64_t done = sampleBytes_; done < bytes;) {
            const std::uint64_t piece = std::min(done, bytes - done);
            std::memcpy(to + done, to, piece);
            done += piece;
        }
    }

    const ZarrStore& store_;
    const ZarrArray& array_;
    const ZarrCut& cut_;
    const ZarrRegion region_;
    const TouchedFiles touched_;
    std::byte* const out_;
    const std::size_t sampleBytes_;
    const bool isWhole_;
    ZarrIndex strides_;  ///< of each dimension in a chunk as it is stored, in samples
    std::atomic<std::int64_t> missing_{0}, chunks_{0};
    std::atomic<bool> hasMoreBeyond_{false};
};

/// \param counts  along each axis
std::uint64_t requireFewFiles(const fs::path& root, const std::array<std::uint64_t, 3>& counts) {
    constexpr std::uint64_t kMostFiles = std::uint64_t{1} << 20;
    std::uint64_t files = 1;
    for (const std::uint64_t count : counts) files = requireProduct(root, files, count);
    if (files > kMostFiles) {
        refuse(root,
               fmt::format("consists of {} files, more than the {} that are read here", files,
                           kMostFiles),
               "take a coarser level (--level), or write it in larger chunks or shards");
    }
    return files;
}

/// Reads each file once, several at a time unless chunks are so large that memory would be short.
void assemble(const ZarrStore& store, const ZarrArray& array, Assembly& assembly) {
    constexpr std::uint64_t kLargeChunk = std::uint64_t{64} << 20;  // bytes
    const std::uint64_t files = requireFewFiles(store.root(), assembly.files());
    const bool isSerial = array.chunkSamples() * bytesPerPixel(array.type) > kLargeChunk;
    const auto count = static_cast<std::int64_t>(files);
    parallelForPieces(count, isSerial ? count : 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) assembly.addFile(static_cast<std::uint64_t>(n));
    });
}

/// \throws FileError  the image is so large for the files of its chunks, however often these are
///                    named, that there is next to nothing in it
void requirePlausibleSize(const ZarrImage& image) {
    const ZarrRegion whole{{0, 0, 0}, image.geometry.size};
    const std::uint64_t bytes =
        requireImageBytes(image.store.root(), image.geometry.size, image.array.type);
    if (kImageUnpackLimit.allows(0, bytes)) return;
    const TouchedFiles touched(image.array, image.cut, whole);
    const std::uint64_t files = requireFewFiles(image.store.root(), touched.counts());
    std::uint64_t stored = 0;
    for (std::uint64_t n = 0; n < files; ++n) {
        const auto file = image.store.open(image.array.key(touched.indexOf(n)));
        if (file) stored += file->size();
        if (kImageUnpackLimit.allows(stored, bytes)) return;
    }
    refuse(image.store.root(),
           fmt::format("its chunks of {} bytes expand to a size of {}, as only a decompression "
                       "bomb or an empty image does",
                       stored, bytes),
           "take a coarser level (--level), or adaptiso-giant, which works tile by tile");
}

/// Looks for a file of a chunk beyond the array's shape by the names in its folder alone.
class ChunksBeyond {
public:
    ChunksBeyond(const ZarrStore& store, const ZarrArray& array) : array_(array) {
        const ZarrIndex& side = array.sharding ? array.sharding->shard : array.chunk;
        for (std::size_t n = 0; n < array.rank(); ++n) {
            counts_.push_back((array.shape[n] + side[n] - 1) / side[n]);
        }
        if (array.isN5) std::reverse(counts_.begin(), counts_.end());
        folder_ = store.root() / array.path;
    }

    /// Relative to the array's folder; empty if missing among the first names.
    fs::path find() {
        if (array_.separator != '/') return findFlat();
        return array_.hasKeyPrefix ? findBelow("c", 0, false) : findBelow("", 0, false);
    }

private:
    /// As keys write it. \return  empty for other names
    static std::optional<std::uint64_t> numberOf(std::string_view text) {
        std::uint64_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool isWhole = error == std::errc() && end == text.data() + text.size();
        const bool isKey = isWhole && (text == "0" || text.front() != '0');
        return isKey ? std::optional(number) : std::nullopt;
    }

    /// Calls f(entry) for a folder's entries, while it is false and `left_` lasts.
    template <class F>
    void forEach(const fs::path& folder, const F& f) {
        std::error_code error;
        for (fs::directory_iterator at(folder, error), end; !error && at != end;
             at.increment(error)) {
            if (left_-- <= 0 || f(*at)) return;
        }
    }

    /// "0.0.3", "c.0.0.3"
    fs::path findFlat() {
        fs::path found;
        forEach(folder_, [&](const fs::directory_entry& entry) {
            const std::string name = entry.path().filename().string();
            std::string_view rest = name;
            if (array_.hasKeyPrefix) {
                if (!rest.starts_with("c.")) return false;
                rest.remove_prefix(2);
            }
            bool isBeyond = false;
            for (std::size_t n = 0; n < counts_.size(); ++n) {
                const bool isLast = n + 1 == counts_.size();
                const std::size_t end = isLast ? rest.size() : rest.find(array_.separator);
                if (end == rest.npos) return false;
                const auto number = numberOf(rest.substr(0, end));
                if (!number) return false;
                isBeyond = isBeyond || *number >= counts_[n];
                rest.remove_prefix(isLast ? end : end + 1);
            }
            if (isBeyond) found = name;
            return isBeyond;
        });
        return found;
    }

    /// "0/0/3"; a folder may be empty. Links to folders are not followed.
    fs::path findBelow(const fs::path& parent, std::size_t dimension, bool isBeyond) {
        fs::path found;
        forEach(folder_ / parent, [&](const fs::directory_entry& entry) {
            const fs::path name = entry.path().filename();
            const auto number = numberOf(name.native());
            if (!number) return false;
            const bool isOwn = isBeyond || *number >= counts_[dimension];
            std::error_code error;
            if (dimension + 1 < counts_.size()) {
                const bool isFolder = fs::is_directory(entry.symlink_status(error));
                if (isFolder) found = findBelow(parent / name, dimension + 1, isOwn);
            } else if (isOwn && !entry.is_directory(error)) {
                found = parent / name;
            }
            return !found.empty();
        });
        return found;
    }

    const ZarrArray& array_;
    fs::path folder_;
    ZarrIndex counts_;                           ///< of files, in the order of keys
    std::int64_t left_ = std::int64_t{1} << 17;  ///< names to look at
};

/// "beyond the shape that its metadata state (5 x 6 x 7)"
std::string beyondShape(const ZarrArray& array) {
    return fmt::format("beyond the shape that its metadata state ({})",
                       fmt::join(array.shape, " x "));
}

/// \throws FileError  the store holds more of the image than the shape in its metadata
void requireNoChunksBeyond(const ZarrStore& store, const ZarrArray& array) {
    const fs::path beyond = ChunksBeyond(store, array).find();
    if (beyond.empty()) return;
    refuse(
        store.root() / array.path,
        fmt::format("holds chunks {}: {}", beyondShape(array), printable(beyond.generic_string())),
        "correct the shape, or remove the chunks that are no part of the image");
}

}  // namespace

bool ZarrCut::isSpace(std::size_t dimension) const {
    return std::find(space.begin(), space.end(), dimension) != space.end();
}

std::string ZarrImage::format() const {
    return scene.axes.empty() && !array.isN5 ? fmt::format("Zarr {}", array.version) : scene.format;
}

ZarrImage openZarrImage(const fs::path& folder, const ReadOptions& options) {
    const ZarrStore store(folder);
    ZarrScene scene = findZarrScene(store, options.level.value_or(0));
    std::optional<ZarrArray> array = readZarrArray(store, scene.path);
    if (!array) {
        refuse(folder / scene.path, "there is no array, which the metadata name",
               "get the dataset again");
    }
    requireNoChunksBeyond(store, *array);
    ZarrCut cut = cutOf(folder, *array, scene, options);
    const ImageGeometry geometry = geometryOf(folder, *array, cut, options.space, scene);
    requireImageBytes(folder, geometry.size, array->type);
    requireUsableGeometry(folder, geometry);
    return {store, std::move(scene), std::move(*array), std::move(cut), geometry};
}

ZarrPart readZarrPart(const ZarrImage& image, const ZarrRegion& region) {
    const fs::path& folder = image.store.root();
    std::uint64_t bytes = bytesPerPixel(image.array.type);
    ImageGeometry geometry = image.geometry;
    Vec3 first;
    for (int a = 0; a < 3; ++a) {
        bytes *= static_cast<std::uint64_t>(region.size[a]);
        first[a] = static_cast<double>(region.first[a]);
    }
    if (region.first != Index3{0, 0, 0}) geometry.originMm = geometry.toPhysical(first);
    geometry.size = region.size;
    SampleBuffer samples = allocateSamples(folder, bytes);
    Assembly assembly(image, region, samples.get());
    try {
        assemble(image.store, image.array, assembly);
    } catch (const std::bad_alloc&) {
        refuseShort(folder, "needs more memory for its chunks than there is",
                    "use a machine with more memory");
    }
    return {makeVolume(std::move(samples), image.array.type, geometry), assembly.chunks(),
            assembly.missing(), assembly.hasMoreBeyond()};
}

void forEachZarrFile(const ZarrImage& image, const ZarrRegion& region,
                     const std::function<void(const std::string&)>& f) {
    const TouchedFiles touched(image.array, image.cut, region);
    const std::array<std::uint64_t, 3>& counts = touched.counts();
    for (std::uint64_t n = 0; n < counts[0] * counts[1] * counts[2]; ++n) {
        f(image.array.key(touched.indexOf(n)));
    }
}

ReadVolume readZarr(const fs::path& folder, const ReadOptions& options) {
    ZarrImage image = openZarrImage(folder, options);
    requirePlausibleSize(image);
    ZarrPart part = readZarrPart(image, {{0, 0, 0}, image.geometry.size});
    if (part.missing > 0) {
        const std::string text =
            fmt::format("{} of its {} chunks are not there", part.missing, part.chunks);
        if (options.refusesMissingChunks) {
            refuse(folder, text, "get the whole dataset, or leave --refuse-missing-chunks out");
        }
        image.scene.warnings.push_back(
            {"missing-chunks", text + "; the fill value stands for them"});
    }
    if (part.hasMoreBeyond) {
        image.scene.warnings.push_back(
            {"trailing-bytes", fmt::format("its chunks hold more than padding {}; it was left out",
                                           beyondShape(image.array))});
    }
    return {std::move(part.volume), image.format(), std::move(image.scene.warnings)};
}

}  // namespace adaptiso::detail
