#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "FileFault.h"
#include "ZarrArray.h"
#include "ZarrStore.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParseJson.h"

// N5's specification (its README, file format 2.5): dimensions from the fastest on, big-endian
// samples, blocks with a header each. Here dimensions are turned into Zarr's order as soon as they
// are read.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kAttributes = "attributes.json";
constexpr std::int64_t kMostLevels = 64;

std::string attributesOf(const std::string& path) {
    return path.empty() ? kAttributes : path + "/" + kAttributes;
}

bool isArray(const ZarrJson& attributes) {
    return !memberOf(attributes, "dimensions").is_null() &&
           !memberOf(attributes, "blockSize").is_null();
}

/// Reads a file that may be another program's: only to recognise N5.
ZarrJson looked(const ZarrStore& store, const std::string& path) {
    try {
        return parseJson<ZarrJson>(store.readText(attributesOf(path)).value_or(""));
    } catch (const FileError&) {
        return {};
    }
}

ZarrIndex reversed(ZarrIndex index) {
    std::reverse(index.begin(), index.end());
    return index;
}

// ---- blocks

/// The lists of a block's header, big-endian.
class BlockHeader {
public:
    BlockHeader(const std::vector<std::byte>& bytes, const fs::path& file)
        : bytes_(bytes), file_(file) {}

    std::uint64_t take(std::size_t byteCount) {
        if (byteCount > bytes_.size() - at_) {
            refuse(file_, "is too short for the header of a block", "get the dataset again");
        }
        std::uint64_t number = 0;
        for (std::size_t n = 0; n < byteCount; ++n) {
            number = number << 8 | std::to_integer<std::uint64_t>(bytes_[at_++]);
        }
        return number;
    }
    std::size_t end() const { return at_; }

private:
    const std::vector<std::byte>& bytes_;
    const fs::path& file_;
    std::size_t at_ = 0;
};

/// Sides of a block in Zarr's order: of each what lies in the array, or a whole one.
ZarrIndex sidesOf(BlockHeader& header, const ZarrArray& array, const ZarrIndex& first,
                  const fs::path& file) {
    const std::uint64_t mode = header.take(2);
    if (mode != 0) {
        refuse(file, fmt::format("is a block of mode {}, which is not read here", mode),
               "write the array anew in blocks of mode 0");
    }
    const std::uint64_t rank = header.take(2);
    ZarrIndex sides;
    for (std::uint64_t n = 0; n < rank && n < array.rank(); ++n) sides.push_back(header.take(4));
    sides = reversed(std::move(sides));
    bool isGood = rank == array.rank();
    for (std::size_t n = 0; isGood && n < sides.size(); ++n) {
        const std::uint64_t rest = array.shape[n] - std::min(array.shape[n], first[n]);
        isGood = sides[n] == std::min(rest, array.chunk[n]) || sides[n] == array.chunk[n];
    }
    if (!isGood) {
        refuse(file, "is damaged: its header and the metadata do not agree on the block's size",
               "get the dataset again");
    }
    return sides;
}

/// Rows of a block to their places in a whole one.
std::vector<std::byte> padded(const std::vector<std::byte>& block, const ZarrIndex& sides,
                              const ZarrArray& array) {
    const std::size_t sample = bytesPerPixel(array.type), last = sides.size() - 1;
    std::vector<std::byte> chunk(static_cast<std::size_t>(array.chunkSamples()) * sample);
    const auto row = static_cast<std::size_t>(sides[last]) * sample;
    ZarrIndex at(sides.size(), 0);
    for (std::size_t begin = 0; begin < block.size(); begin += row) {
        std::uint64_t to = 0;
        for (std::size_t n = 0; n < sides.size(); ++n) to = to * array.chunk[n] + at[n];
        std::memcpy(chunk.data() + to * sample, block.data() + begin, row);
        for (std::size_t n = last; n-- > 0 && ++at[n] == sides[n];) at[n] = 0;
    }
    return chunk;
}

// ---- arrays

/// None for "raw". Before version 2 of N5 the metadata had the name alone.
void takeCompression(const fs::path& file, const ZarrJson& json, ZarrArray& array) {
    const ZarrJson& old = memberOf(json, "compressionType");
    const std::string name = old.is_string() ? old.get<std::string>()
                                             : textOf(file, memberOf(json, "compression"), "type");
    if (name == "raw") return;
    constexpr std::pair<std::string_view, ZarrCodec> kCodecs[] = {{"gzip", ZarrCodec::Deflate},
                                                                  {"lz4", ZarrCodec::Lz4Stream},
                                                                  {"zstd", ZarrCodec::Zstd},
                                                                  {"blosc", ZarrCodec::Blosc}};
    for (const auto& [known, codec] : kCodecs) {
        if (name != known) continue;
        array.encoding.codecs.push_back(codec);
        return;
    }
    refuse(file, fmt::format("its compression {} is not read here", printable(name)),
           "write the array with raw, gzip, lz4, zstd or blosc blocks");
}

// ---- images

/// One number for each dimension, in Zarr's order; a list of three is that of the fastest.
/// \param otherwise  of dimensions that are not in it
std::vector<double> numbersFor(const fs::path& file, const ZarrJson& list, std::size_t rank,
                               const char* what) {
    constexpr std::size_t kSpace = 3;
    std::vector<double> numbers;
    for (const ZarrJson& value : list.is_array() ? list : ZarrJson::array()) {
        if (value.is_number()) numbers.push_back(value.get<double>());
    }
    const bool isGood = std::all_of(numbers.begin(), numbers.end(), [](double number) {
        return std::isfinite(number) && number > 0;
    });
    if (!isGood || numbers.size() != list.size() ||
        (numbers.size() != rank && (numbers.size() != kSpace || rank < kSpace))) {
        refuse(file,
               fmt::format("its metadata are damaged: {} has not one number above 0 for each axis",
                           what),
               "repair them");
    }
    numbers.resize(rank, 1);
    std::reverse(numbers.begin(), numbers.end());
    return numbers;
}

ZarrAxis axisOf(const std::string& name) {
    ZarrAxis axis;
    axis.name = name;
    if (name == "x" || name == "y" || name == "z") axis.kind = ZarrAxis::Kind::Space;
    if (name == "c") axis.kind = ZarrAxis::Kind::Channel;
    if (name == "t") axis.kind = ZarrAxis::Kind::Time;
    return axis;
}

/// By their names, or else the first three are x, y and z.
std::vector<ZarrAxis> axesOf(const fs::path& file, const ZarrJson& names, std::size_t rank) {
    constexpr const char* kSpace[] = {"x", "y", "z"};
    std::vector<ZarrAxis> axes;
    for (std::size_t n = 0; n < rank; ++n) {
        std::string name = n < std::size(kSpace) ? kSpace[n] : "";
        if (!names.is_null()) {
            const bool isThere = names.is_array() && names.size() == rank && names[n].is_string();
            if (!isThere) {
                refuse(file, "its metadata are damaged: axes has not one name for each dimension",
                       "repair them");
            }
            name = names[n].get<std::string>();
        }
        axes.push_back(axisOf(name));
    }
    std::reverse(axes.begin(), axes.end());
    return axes;
}

/// A member of the array's attributes, or of its group's.
const ZarrJson& memberOfEither(const ZarrJson& own, const ZarrJson& group, const char* key) {
    const ZarrJson& value = memberOf(own, key);
    return value.is_null() ? memberOf(group, key) : value;
}

void takeUnit(const fs::path& file, const std::string& unit, ZarrAxis& axis) {
    if (axis.kind == ZarrAxis::Kind::Space) axis.toMm = millimetresOf(file, unit);
}

/// Sizes of voxels of the finest resolution: n5-viewer's pixelResolution, or resolution and units.
void takeResolution(const fs::path& file, const ZarrJson& own, const ZarrJson& group,
                    ZarrScene& scene) {
    const std::size_t rank = scene.axes.size();
    const ZarrJson& pixel = memberOfEither(own, group, "pixelResolution");
    if (!pixel.is_null()) {
        const bool isList = pixel.is_array();  // of micrometres, as n5-viewer takes it
        const ZarrJson& unit = memberOf(pixel, "unit");
        const std::string name = unit.is_string() ? unit.get<std::string>() : isList ? "um" : "";
        scene.scale = numbersFor(file, isList ? pixel : memberOf(pixel, "dimensions"), rank,
                                 "pixelResolution");
        scene.saysScale = true;
        for (ZarrAxis& axis : scene.axes) takeUnit(file, name, axis);
        return;
    }
    const ZarrJson& resolution = memberOfEither(own, group, "resolution");
    if (!resolution.is_null()) {
        scene.scale = numbersFor(file, resolution, rank, "resolution");
        scene.saysScale = true;
    }
    const ZarrJson& units = memberOfEither(own, group, "units");
    if (units.is_null()) return;
    for (std::size_t n = 0; n < rank; ++n) {
        if (!units.is_array() || units.size() != rank || !units[n].is_string()) {
            refuse(file, "its metadata are damaged: units has not one name for each axis",
                   "repair them");
        }
        takeUnit(file, units[n].get<std::string>(), scene.axes[rank - 1 - n]);
    }
}

/// Voxels of the finest resolution along one of this, for each axis.
std::vector<double> factorsOf(const fs::path& file, const ZarrJson& own, const ZarrJson& group,
                              std::int64_t level, std::size_t rank) {
    const ZarrJson& factors = memberOf(own, "downsamplingFactors");
    if (!factors.is_null()) return numbersFor(file, factors, rank, "downsamplingFactors");
    for (const char* const key : {"downsamplingFactors", "scales"}) {
        const ZarrJson& list = memberOf(group, key);
        const auto at = static_cast<std::size_t>(level);
        if (list.is_array() && at < list.size()) return numbersFor(file, list[at], rank, key);
    }
    if (level == 0) return std::vector<double>(rank, 1);
    refuse(file, fmt::format("nothing says how coarse level {} is (downsamplingFactors)", level),
           "take --level 0, or repair the metadata");
}

ZarrScene sceneOf(const fs::path& file, const ZarrJson& own, const ZarrJson& group,
                  std::int64_t level) {
    ZarrScene scene;
    scene.format = "N5";
    const std::size_t rank = numbersOf(file, own, "dimensions", 1).size();
    if (!memberOfEither(own, group, "affineTransform").is_null()) {
        refuse(file, "its affineTransform is not read here", "write the image without it");
    }
    const std::vector<double> factors = factorsOf(file, own, group, level, rank);
    const auto says = [&](const char* key) { return !memberOfEither(own, group, key).is_null(); };
    const bool isPlaced =
        says("pixelResolution") || says("resolution") || says("axes") ||
        std::any_of(factors.begin(), factors.end(), [](double f) { return f != 1; });
    if (!isPlaced) return scene;  // an array that says nothing of voxels
    scene.axes = axesOf(file, memberOfEither(own, group, "axes"), rank);
    scene.scale.assign(rank, 1);
    takeResolution(file, own, group, scene);
    scene.shift.assign(rank, 0);
    for (std::size_t n = 0; n < rank; ++n) {
        scene.shift[n] = 0.5 * (factors[n] - 1) * scene.scale[n];
        scene.scale[n] *= factors[n];
    }
    return scene;
}

std::string levelPath(std::int64_t level) {
    return "s" + std::to_string(level);
}

}  // namespace

bool isN5Folder(const fs::path& folder) {
    const ZarrStore store(folder);
    const ZarrJson root = looked(store, "");
    return isArray(root) || !memberOf(root, "n5").is_null() || isArray(looked(store, levelPath(0)));
}

std::optional<ZarrArray> readN5Array(const ZarrStore& store, const std::string& path) {
    const std::optional<ZarrJson> json = readZarrJson(store, attributesOf(path));
    if (!json || !isArray(*json)) return std::nullopt;
    const fs::path file = store.root() / attributesOf(path);
    ZarrArray array;
    array.isN5 = true;
    array.path = path;
    array.shape = reversed(numbersOf(file, *json, "dimensions", 1));
    array.chunk = reversed(numbersOf(file, *json, "blockSize", 1));
    array.type = zarrTypeOf(file, "dataType", textOf(file, *json, "dataType"));
    array.encoding.byteOrder = std::endian::big;
    array.encoding.order.resize(array.rank());
    std::iota(array.encoding.order.begin(), array.encoding.order.end(), std::size_t{0});
    takeCompression(file, *json, array);
    requireZarrSizes(file, array);
    return array;
}

std::optional<ZarrScene> findN5Scene(const ZarrStore& store, std::int64_t level) {
    const ZarrJson root = readZarrJson(store, kAttributes).value_or(ZarrJson());
    if (isArray(root)) {
        if (level != 0) {
            refuse(store.root(), "is one array, which has no levels", "leave --level out");
        }
        return sceneOf(store.root() / kAttributes, root, {}, 0);
    }
    std::int64_t levels = 0;
    while (levels < kMostLevels && isArray(looked(store, levelPath(levels)))) ++levels;
    if (levels == 0) {
        if (memberOf(root, "n5").is_null()) return std::nullopt;
        refuse(store.root(), "is a container of N5 that is no image itself",
               "give an array in it, or the folder of s0, s1, ...");
    }
    if (level < 0 || level >= levels) refuseLevel(store.root(), level, levels);
    const std::string key = attributesOf(levelPath(level));
    ZarrScene scene = sceneOf(store.root() / key, *readZarrJson(store, key), root, level);
    scene.path = levelPath(level);
    scene.levels = levels;
    return scene;
}

std::vector<std::byte> unpackN5Block(std::vector<std::byte> packed, const ZarrArray& array,
                                     const ZarrIndex& first, const fs::path& file) {
    BlockHeader header(packed, file);
    const ZarrIndex sides = sidesOf(header, array, first, file);
    packed.erase(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(header.end()));
    std::uint64_t bytes = bytesPerPixel(array.type);
    for (const std::uint64_t side : sides) bytes *= side;
    packed = unpackZarrChunk(std::move(packed), array.encoding.codecs, bytes, file);
    return sides == array.chunk ? packed : padded(packed, sides, array);
}

}  // namespace adaptiso::detail
