#include <fmt/core.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "Samples.h"
#include "adaptiso/Core/TextLines.h"

// MetaIO opens whatever file a header names, leaves memory uninitialised where data are short,
// crashes on odd NDims and copies the samples. The format is a text header and plain or zlib
// samples, so it is read here. Keys: itk.org/Wiki/ITK/MetaIO/Documentation.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuseMetaHeader(const fs::path& file, const std::string& what,
                                   const std::string& remedy = "repair the header") {
    refuse(file, "its MetaImage header is damaged: " + what, remedy);
}

struct MetaHeader {
    std::map<std::string, std::string, std::less<>> fields;
    std::uint64_t byteCount = 0;  ///< up to and with the ElementDataFile line

    std::optional<std::string_view> find(std::initializer_list<std::string_view> names) const {
        for (const std::string_view name : names) {
            const auto it = fields.find(name);
            if (it != fields.end()) return it->second;
        }
        return std::nullopt;
    }
    std::string_view require(const fs::path& file, std::string_view name) const {
        if (const auto value = find({name})) return *value;
        refuse(file, fmt::format("its MetaImage header misses {}", name), "repair the header");
    }
};

MetaHeader parseHeader(const fs::path& file) {
    const std::string text = readHead(file, kLongestHeader);
    MetaHeader header;
    TextLines lines(text, LineEnds::OfFirst);
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        header.byteCount = lines.position();
        if (line.empty()) continue;
        const std::size_t sign = line.find_first_of("=:");
        if (sign == std::string_view::npos) {
            refuse(file, "its MetaImage header is damaged (a line is no 'key = value')",
                   "repair the header");
        }
        const std::string name(trimmed(line.substr(0, sign)));
        if (!header.fields.emplace(name, trimmed(line.substr(sign + 1))).second) {
            refuse(file, fmt::format("its MetaImage header has '{}' twice", printable(name)),
                   "repair the header");
        }
        if (name == "ElementDataFile") return header;
    }
    refuse(file,
           text.size() == kLongestHeader ? "its MetaImage header is longer than 1 MiB"
                                         : "its MetaImage header has no ElementDataFile",
           "repair the header");
}

PixelType parseType(const fs::path& file, std::string_view text) {
    static const std::map<std::string_view, PixelType> kTypes = {
        {"MET_CHAR", PixelType::Int8},       {"MET_UCHAR", PixelType::UInt8},
        {"MET_SHORT", PixelType::Int16},     {"MET_USHORT", PixelType::UInt16},
        {"MET_INT", PixelType::Int32},       {"MET_UINT", PixelType::UInt32},
        {"MET_LONG", PixelType::Int32},      {"MET_ULONG", PixelType::UInt32},
        {"MET_LONG_LONG", PixelType::Int64}, {"MET_ULONG_LONG", PixelType::UInt64},
        {"MET_FLOAT", PixelType::Float32},   {"MET_DOUBLE", PixelType::Float64}};
    const auto it = kTypes.find(text);
    if (it == kTypes.end()) {
        refuse(file, fmt::format("unsupported ElementType '{}'", printable(text)),
               "convert it to a scalar integer or float type");
    }
    return it->second;
}

bool parseFlag(const fs::path& file, const MetaHeader& header,
               std::initializer_list<std::string_view> names) {
    const std::string text = lowerCase(header.find(names).value_or("false"));
    if (text == "true" || text == "1") return true;
    if (text == "false" || text == "0") return false;
    refuseMetaHeader(file, fmt::format("{} is '{}'", *names.begin(), printable(text)),
                     "it must be True or False");
}

std::vector<double> numbersIn(const fs::path& file, std::string_view name, std::string_view text,
                              std::size_t count) {
    std::vector<double> numbers;
    for (const std::string_view word : words(text)) {
        const auto value = parseNumber(word);
        if (!value || !std::isfinite(*value)) {
            refuseMetaHeader(
                file, fmt::format("{} holds '{}', not a finite number", name, printable(word)));
        }
        numbers.push_back(*value);
    }
    if (numbers.size() != count) {
        refuseMetaHeader(
            file, fmt::format("{} holds {} numbers, must hold {}", name, numbers.size(), count));
    }
    return numbers;
}

/// `count` finite numbers under one of several names, or nothing when none of them is there.
std::optional<std::vector<double>> parseNumbers(const fs::path& file, const MetaHeader& header,
                                                std::initializer_list<std::string_view> names,
                                                std::size_t count) {
    std::optional<std::vector<double>> numbers;
    std::string_view first;
    for (const std::string_view name : names) {
        const auto text = header.find({name});
        if (!text) continue;
        std::vector<double> found = numbersIn(file, name, *text, count);
        if (numbers && *numbers != found) {
            refuse(file,
                   fmt::format("its MetaImage header contradicts itself: {} and {} differ", first,
                               name),
                   "remove the wrong one");
        }
        if (!numbers) first = name;
        numbers = std::move(found);
    }
    return numbers;
}

/// MetaIO keeps tubes, meshes, landmarks and more in files that look alike.
void requireImage(const fs::path& file, const MetaHeader& header) {
    const auto type = header.find({"ObjectType"});
    if (!type || lowerCase(*type) == "image") return;
    refuse(file, fmt::format("its ObjectType is '{}', not Image", printable(*type)),
           "give an image; adaptiso reads no other MetaIO objects");
}

/// intensity = slope * element + offset.
void parseScaling(const fs::path& file, const MetaHeader& header, SampleLayout& layout,
                  std::vector<Warning>& warnings) {
    const auto slope = parseNumbers(file, header, {"ElementToIntensityFunctionSlope"}, 1);
    const auto offset = parseNumbers(file, header, {"ElementToIntensityFunctionOffset"}, 1);
    if (slope) layout.slope = slope->front();
    if (offset) layout.intercept = offset->front();
    if (layout.slope == 0) {
        refuse(file, "its ElementToIntensityFunctionSlope is 0: the image would be constant",
               "repair the header");
    }
    layout.isScaled = layout.slope != 1 || layout.intercept != 0;
    if (!layout.isScaled) return;
    warnings.push_back(
        {"values-scaled",
         fmt::format(
             "values are {} x stored value + {}, as its ElementToIntensityFunction says; ITK "
             "and programs that rest on it show the stored values",
             number(layout.slope), number(layout.intercept))});
}

struct MetaExtents {
    std::size_t dimensions = 3;
    Index3 size{};
    std::int64_t volumeCount = 1;
};

/// 3 dimensions, or 4, the last of which counts volumes.
MetaExtents parseExtents(const fs::path& file, const MetaHeader& header) {
    const auto dimensions = parseInteger(header.require(file, "NDims"));
    if (!dimensions || *dimensions < 1 || *dimensions > 10) {
        refuseMetaHeader(file, "NDims must be 1 to 10");
    }
    if (*dimensions != 3 && *dimensions != 4) {
        refuse(file, fmt::format("has {} dimensions, must have 3", *dimensions),
               "extract one volume first");
    }
    MetaExtents extents{static_cast<std::size_t>(*dimensions)};
    const auto sizes = words(header.require(file, "DimSize"));
    if (sizes.size() != extents.dimensions) {
        refuseMetaHeader(file, fmt::format("DimSize holds {} numbers for NDims {}", sizes.size(),
                                           extents.dimensions));
    }
    for (std::size_t axis = 0; axis < extents.dimensions; ++axis) {
        const auto extent = parseInteger(sizes[axis]);
        if (!extent) refuseMetaHeader(file, "DimSize holds no whole numbers");
        if (axis < 3) {
            extents.size[axis] = *extent;
        } else {
            if (*extent < 1) refuseMetaHeader(file, "DimSize holds a number below 1");
            extents.volumeCount = *extent;
        }
    }
    return extents;
}

void requireScalar(const fs::path& file, const MetaHeader& header) {
    const auto text = header.find({"ElementNumberOfChannels"});
    if (text && parseInteger(*text) != 1) {
        refuse(file,
               fmt::format("has {} channels (colour or vectors), must have 1", printable(*text)),
               "extract one scalar channel first");
    }
}

/// Plus and 3D Slicer write tracked 2-D images one behind the other, a place in space for each.
void requireNoSequence(const fs::path& file, const MetaHeader& header) {
    const auto refused = [&](std::string_view what) {
        refuse(file,
               fmt::format("{}, not a direction in space (components or a list of images)", what),
               "extract one scalar volume first");
    };
    const auto kinds = words(header.find({"Kinds"}).value_or(""));
    for (std::size_t axis = 0; axis < kinds.size() && axis < 3; ++axis) {
        if (isSpatialKind(lowerCase(kinds[axis]))) continue;
        refused(fmt::format("an axis is a '{}'", printable(kinds[axis])));
    }
    const auto frame = header.fields.lower_bound("Seq_Frame");
    if (kinds.empty() && frame != header.fields.end() && frame->first.starts_with("Seq_Frame")) {
        refused("an axis is a sequence of frames (Seq_Frame...)");
    }
}

/// Row a of TransformMatrix is the direction of axis a; LPS mm, as ITK writes it.
ImageGeometry geometryOf(const fs::path& file, const MetaHeader& header, const MetaExtents& extents,
                         std::vector<Warning>& warnings) {
    const std::size_t n = extents.dimensions;
    const std::string units = lowerCase(header.find({"DistanceUnits"}).value_or("mm"));
    if (units != "mm" && units != "?") {
        refuse(file, fmt::format("its DistanceUnits are '{}'", printable(units)), "save it in mm");
    }
    auto spacing = parseNumbers(file, header, {"ElementSpacing"}, n);
    if (!spacing) spacing = parseNumbers(file, header, {"ElementSize"}, n);
    if (!spacing) {
        warnings.push_back({"guessed-spacing", "no ElementSpacing: a spacing of 1 mm was used"});
        spacing.emplace(n, 1.0);
    }
    const auto matrix =
        parseNumbers(file, header, {"TransformMatrix", "Rotation", "Orientation"}, n * n);
    if (!matrix)
        warnings.push_back(
            {"guessed-orientation", "no TransformMatrix: the axes were taken as LPS"});
    const auto origin = parseNumbers(file, header, {"Offset", "Origin", "Position"}, n);
    if (!origin)
        warnings.push_back({"guessed-position", "no Offset: the first voxel was put at 0, 0, 0"});

    ImageGeometry geometry{extents.size, {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!((*spacing)[axis] > 0)) {
            refuse(file,
                   fmt::format("voxel spacing {} must be above zero (not zero, not negative)",
                               number((*spacing)[axis])),
                   "repair ElementSpacing");
        }
        for (std::size_t row = 0; row < 3; ++row) {
            const double direction = matrix ? (*matrix)[axis * n + row] : (axis == row ? 1 : 0);
            geometry.indexToPhysical.column[axis][static_cast<int>(row)] =
                (*spacing)[axis] * direction;
        }
        if (origin) geometry.originMm[static_cast<int>(axis)] = (*origin)[axis];
    }
    return geometry;
}

/// -1: the samples are the last bytes of the file; 0: they follow the header, if there is one.
std::int64_t parseHeaderSize(const fs::path& file, const MetaHeader& header, bool isCompressed,
                             std::uint64_t least) {
    const auto text = header.find({"HeaderSize"});
    if (!text) return 0;
    const auto size = parseInteger(*text);
    if (!size || *size < -1 || (isCompressed && *size != 0) ||
        (*size > 0 && static_cast<std::uint64_t>(*size) < least)) {
        refuseMetaHeader(file, fmt::format("HeaderSize '{}'", printable(*text)));
    }
    return *size;
}

std::endian byteOrderOf(const fs::path& file, const MetaHeader& header, PixelType type) {
    const bool isBig = parseFlag(file, header, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    const bool isAlsoBig =
        parseFlag(file, header, {"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
    if (isBig != isAlsoBig && bytesPerPixel(type) > 1) {
        refuse(file,
               "its MetaImage header contradicts itself: BinaryDataByteOrderMSB and "
               "ElementByteOrderMSB differ",
               "remove the wrong one");
    }
    return isBig ? std::endian::big : std::endian::little;
}

DataPlace placeOf(const fs::path& file, const MetaHeader& header) {
    const std::string_view name = header.require(file, "ElementDataFile");
    const bool isLocal = lowerCase(name) == "local";
    if (!parseFlag(file, header, {"BinaryData"})) {
        refuse(file, "its data are text (BinaryData is not True)", "save it as binary");
    }
    DataPlace place{file, isLocal ? file : requireDataFile(file, name)};
    const bool isCompressed = parseFlag(file, header, {"CompressedData"});
    if (isCompressed) place.encoding = ByteSource::Encoding::Deflate;
    if (isLocal) place.begin = header.byteCount;
    const std::int64_t headerSize = parseHeaderSize(file, header, isCompressed, place.begin);
    place.countsFromEnd = headerSize == -1;
    if (headerSize > 0) place.bytes = static_cast<std::uint64_t>(headerSize) - place.begin;
    place.skipName = "HeaderSize";
    place.gzipField = "CompressedData = True";
    return place;
}

/// MetaIO's MET_LONG has 4 bytes on every machine; other writers take their own long of 8.
void requireFourByteLong(const fs::path& file, std::string_view type, const ByteTail& tail,
                         std::uint64_t byteCount) {
    if (tail.byteCount != byteCount || (type != "MET_LONG" && type != "MET_ULONG")) return;
    refuse(
        file,
        fmt::format("its ElementType {} has 4 bytes (MetaIO), but its data hold 8 for each "
                    "voxel",
                    type),
        fmt::format("write {}_LONG for integers of 8 bytes, or cut the file to one image", type));
}

}  // namespace

bool looksLikeMetaImage(std::string_view head) {
    head = trimmed(withoutByteOrderMark(head));
    for (const std::string_view key : {"ObjectType", "NDims", "Comment", "BinaryData", "DimSize"}) {
        if (head.starts_with(key) && trimmed(head.substr(key.size())).starts_with('=')) {
            return true;
        }
    }
    return false;
}

ReadVolume readMetaImage(const fs::path& file, const ReadOptions& options) {
    const MetaHeader header = parseHeader(file);
    requireImage(file, header);
    const MetaExtents extents = parseExtents(file, header);
    requireScalar(file, header);
    requireNoSequence(file, header);
    const std::string_view type = header.require(file, "ElementType");
    std::vector<Warning> warnings;
    SampleLayout layout{parseType(file, type)};
    layout.volumeCount = extents.volumeCount;
    const std::uint64_t byteCount =
        requireProduct(file, requireImageBytes(file, extents.size, layout.stored),
                       static_cast<std::uint64_t>(extents.volumeCount));
    layout.volume = chooseVolume(file, extents.volumeCount, options);
    layout.byteOrder = byteOrderOf(file, header, layout.stored);
    parseScaling(file, header, layout, warnings);
    const ImageGeometry geometry = geometryOf(file, header, extents, warnings);
    requireUsableGeometry(file, geometry);
    const DataPlace place = placeOf(file, header);
    PlacedVolume read = readPlaced(place, layout, geometry);
    requireFourByteLong(file, type, read.tail, byteCount);
    checkTail(place, read.tail, layout, extents.size, warnings);
    return {
        std::move(read.volume), "MetaImage", std::move(warnings),
        layout.scalingText("ElementToIntensityFunctionSlope", "ElementToIntensityFunctionOffset")};
}

}  // namespace adaptiso::detail
