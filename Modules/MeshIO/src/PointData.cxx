// FreeSurfer's files of values at points, big endian, as its MRISwriteCurvature and
// MRISwriteAnnotation and nibabel's write_morph_data and write_annot have them.
//   curv   FF FF FF, int32 points, triangles, 1; float32 values.
//          Before 2000: int24 points, triangles; int16 hundredths.
//   annot  int32 points; of each int32 number and int32 label (R + 256 G + 65536 B); then, where
//          int32 1 follows, a table of names and colours, in one of two versions.
// GIFTI 1.0 files of values at points: .shape.gii, .func.gii, .label.gii. Written packed, little
// endian, float32 and int32.
// FreeSurfer's .mgh, big endian: int32 1, width, height, depth, frames, type, degrees of freedom;
// int16 whether a place in space follows; values from byte 284 on, frame after frame. What may
// follow them (times, commands, names) is nobody's. Of a surface's values each frame has
// width x height x depth, one a point.

#include "adaptiso/MeshIO/PointData.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "GiftiArrays.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/MghFooter.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::meshio {

namespace {

/// The metadata that readers need; the rest may name people, places and dates.
GiftiMetadata kept(const GiftiMetadata& metadata, bool isOfArray) {
    GiftiMetadata result;
    for (const auto& [name, value] : metadata) {
        if (!name.starts_with("AnatomicalStructure") && !(isOfArray && name == "Name")) continue;
        result.emplace_back(storedName(name), storedName(value));
    }
    return result;
}

PointLabel labelOf(const XmlAttributes& attributes, const std::string& name) {
    PointLabel label;
    const std::string key = attributeOr(attributes, "Key", attributeOr(attributes, "Index", ""));
    label.key = static_cast<std::int32_t>(toInteger(key, "a label's key"));
    label.name = storedName(trimmed(name));
    static constexpr const char* kChannels[] = {"Red", "Green", "Blue", "Alpha"};
    if (attributes.find("Red") == attributes.end()) return label;
    label.rgba.emplace();
    for (std::size_t n = 0; n < 4; ++n) {
        (*label.rgba)[n] = toReal(attributeOr(attributes, kChannels[n], "1"), "a colour");
    }
    return label;
}

/// Makes parts of 1 of colours that are written as 0 to 255, which holds for a whole table.
void settleColors(std::vector<PointLabel>& labels, std::vector<Warning>& warnings) {
    constexpr double kMost = 255;
    const auto isWithin = [](double value, double most) { return value >= 0 && value <= most; };
    bool areParts = true, areAlphasParts = true;
    std::int64_t unread = 0;
    std::string first;
    for (PointLabel& label : labels) {
        if (!label.rgba) continue;
        const auto& [red, green, blue, alpha] = *label.rgba;
        for (const double value : *label.rgba) {
            if (isWithin(value, kMost)) continue;
            if (unread++ == 0) {
                first = "that of label " + std::to_string(label.key) + " is " + formatShort(red) +
                        " " + formatShort(green) + " " + formatShort(blue) + " " +
                        formatShort(alpha);
            }
            label.rgba.reset();
            break;
        }
        if (!label.rgba) continue;
        areParts = areParts && red <= 1 && green <= 1 && blue <= 1;
        areAlphasParts = areAlphasParts && alpha <= 1;
    }
    for (PointLabel& label : labels) {
        for (std::size_t n = 0; label.rgba && n < 4; ++n) {
            if (!(n < 3 ? areParts : areAlphasParts)) (*label.rgba)[n] /= kMost;
        }
    }
    if (unread == 0) return;
    warnings.push_back(
        {"colors-not-read", (unread == 1 ? "a colour is left out: "
                                         : std::to_string(unread) + " colours are left out: ") +
                                first + ", must be parts of 1, or 0 to 255"});
}

/// Keeps the first of the labels that have one key.
void settleKeys(std::vector<PointLabel>& labels, std::vector<Warning>& warnings) {
    std::map<std::int32_t, std::size_t> places;
    std::vector<PointLabel> kept;
    std::set<std::int32_t> repeated;
    for (PointLabel& label : labels) {
        const auto [at, isNew] = places.emplace(label.key, kept.size());
        if (!isNew) {
            const PointLabel& first = kept[at->second];
            if (first.name != label.name || first.rgba != label.rgba) repeated.insert(label.key);
            continue;
        }
        kept.push_back(std::move(label));
    }
    labels = std::move(kept);
    if (repeated.empty()) return;
    const std::string key = std::to_string(*repeated.begin());
    warnings.push_back(
        {"label-listed-twice",
         (repeated.size() == 1 ? "label " + key + " is listed twice"
                               : std::to_string(repeated.size()) + " labels are listed twice, " +
                                     key + " among them") +
             " with different names or colours; the first counts"});
}

PointValues decodeArray(const GiftiArray& stored, Unpacking& unpacking) {
    const XmlAttributes& attributes = stored.attributes;
    PointValues array;
    array.intent = storedName(attributeOr(attributes, "Intent", "NIFTI_INTENT_NONE"));
    if (array.intent == "NIFTI_INTENT_POINTSET" || array.intent == "NIFTI_INTENT_TRIANGLE") {
        unsupported("it is a surface", "give the file of values at its points");
    }
    if (array.intent == "NIFTI_INTENT_NODE_INDEX") {
        unsupported("it has values for some points only", "save it with a value for every point");
    }
    const GiftiShape shape = shapeOf(attributes, "values");
    array.columns = shape.columns;
    array.metadata = kept(stored.metadata, true);
    const std::string& type = requireAttribute(attributes, "DataType");
    if (type == "NIFTI_TYPE_FLOAT32") {
        array.values = decodeGiftiRows<float, float>(stored, shape, "values", unpacking);
    } else if (type == "NIFTI_TYPE_INT32") {
        array.values =
            decodeGiftiRows<std::int32_t, std::int32_t>(stored, shape, "values", unpacking);
    } else if (type == "NIFTI_TYPE_UINT8") {
        array.values =
            decodeGiftiRows<std::uint8_t, std::int32_t>(stored, shape, "values", unpacking);
    } else {
        unsupported("its values are " + printable(type), "save them as NIFTI_TYPE_FLOAT32");
    }
    return array;
}

void encodeMetadata(const GiftiMetadata& metadata, ByteSink& sink) {
    if (metadata.empty()) {
        sink << "<MetaData/>\n";
        return;
    }
    sink << "<MetaData>\n";
    for (const auto& [name, value] : metadata) {
        sink << "<MD><Name>" << escapedMarkup(name) << "</Name><Value>" << escapedMarkup(value)
             << "</Value></MD>\n";
    }
    sink << "</MetaData>\n";
}

void encodeLabels(const std::vector<PointLabel>& labels, ByteSink& sink) {
    if (labels.empty()) {
        sink << "<LabelTable/>\n";
        return;
    }
    sink << "<LabelTable>\n";
    for (const PointLabel& label : labels) {
        sink << "<Label Key=\"" << std::int64_t{label.key} << "\"";
        static constexpr const char* kChannels[] = {" Red=\"", " Green=\"", " Blue=\"",
                                                    " Alpha=\""};
        for (std::size_t n = 0; label.rgba && n < 4; ++n) {
            sink << kChannels[n] << (*label.rgba)[n] << "\"";
        }
        sink << ">" << escapedMarkup(label.name) << "</Label>\n";
    }
    sink << "</LabelTable>\n";
}

/// GIFTI files of values at points. decodePointData() checks what is read, and names the file.
PointData decodeGiftiData(std::string_view bytes) {
    GiftiFile found = parseGifti(bytes);
    PointData data;
    data.format = PointDataFormat::Gifti;
    for (const auto& [attributes, name] : found.labels) {
        data.labels.push_back(labelOf(attributes, name));
    }
    data.metadata = kept(found.metadata, false);
    Unpacking unpacking(bytes.size());
    unpacking.warnings = std::move(found.warnings);
    requireNoMore({"arrays", std::ssize(found.arrays), std::ssize(bytes)}, found.behind,
                  unpacking.warnings);
    for (const GiftiArray& array : found.arrays) {
        data.arrays.push_back(decodeArray(array, unpacking));
    }
    data.warnings = std::move(unpacking.warnings);
    settleColors(data.labels, data.warnings);
    settleKeys(data.labels, data.warnings);
    if (data.arrays.empty()) damaged("it holds no values");
    const PointValues& first = data.arrays.front();
    const auto size = [](const auto& values) { return std::ssize(values); };
    data.points = first.columns > 0 ? std::visit(size, first.values) / first.columns : 0;
    return data;
}

void encodeGiftiData(const PointData& data, std::int64_t, ByteSink& sink) {
    sink << kGiftiHead << "<GIFTI Version=\"1.0\" NumberOfDataArrays=\""
         << static_cast<std::int64_t>(data.arrays.size()) << "\">\n";
    encodeMetadata(data.metadata, sink);
    encodeLabels(data.labels, sink);
    for (const PointValues& array : data.arrays) {
        beginGiftiArray(array.intent.empty() ? "NIFTI_INTENT_NONE" : escapedMarkup(array.intent),
                        array.areLabels() ? "NIFTI_TYPE_INT32" : "NIFTI_TYPE_FLOAT32",
                        {data.points, array.columns}, sink);
        encodeMetadata(array.metadata, sink);
        std::string packed;
        std::visit(
            [&](const auto& values) {
                for (const auto value : values) appendLittleEndian(value, packed);
            },
            array.values);
        endGiftiArray(packed, sink);
    }
    sink << "</GIFTI>\n";
}

constexpr auto kBig = std::endian::big;
constexpr std::size_t kHeader = 284;
constexpr std::int32_t kMghInt = 1, kMghFloat = 3;

PixelType mghType(std::int32_t code) {
    constexpr std::pair<std::int32_t, PixelType> kTypes[] = {{0, PixelType::UInt8},
                                                             {kMghInt, PixelType::Int32},
                                                             {kMghFloat, PixelType::Float32},
                                                             {4, PixelType::Int16}};
    for (const auto& [known, type] : kTypes) {
        if (code == known) return type;
    }
    unsupported("it holds values of type " + std::to_string(code),
                "save it as numbers of type float, int, short or uchar");
}

template <class Value>
PointValues frameOf(ByteSource& source, std::int64_t points, PixelType type) {
    std::vector<Value> values(static_cast<std::size_t>(points));
    for (Value& value : values) value = source.number<Value>(type, kBig);
    return {{}, std::move(values), 1, {}};
}

/// FreeSurfer's .mgh, likewise.
PointData decodeMghData(std::string_view bytes) {
    ByteSource source(bytes);
    if (source.number<std::int32_t>(kBig) != 1) {
        damaged("it does not begin as FreeSurfer's .mgh does");
    }
    PointData data;
    data.format = PointDataFormat::FreeSurferMgh;
    data.points = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t size = source.number<std::int32_t>(kBig);
        if (size == 0) damaged("it holds no values");
        requireRoom("values", size, data.points, bytes.size());
        data.points *= size;
    }
    const std::int64_t frames = source.number<std::int32_t>(kBig);
    const PixelType type = mghType(source.number<std::int32_t>(kBig));
    const auto each = static_cast<std::int64_t>(bytesPerPixel(type));
    if (frames < 1) damaged("it holds no values");
    source.take(kHeader - source.position());
    requireRoom("values", data.points, each, source.left());
    requireRoom("frames", frames, data.points * each, source.left());
    for (std::int64_t n = 0; n < frames; ++n) {
        data.arrays.push_back(isReal(type) ? frameOf<float>(source, data.points, type)
                                           : frameOf<std::int32_t>(source, data.points, type));
    }
    // read as FreeSurfer's volumes are
    if (mghFooterOf(source.rest(), source.left()) != MghFooter::Whole) {
        requireNoMore({"frames", frames, data.points * each}, source.rest(), data.warnings);
    }
    return data;
}

void encodeMghData(const PointData& data, std::int64_t, ByteSink& sink) {
    const bool areLabels = data.arrays.front().areLabels();
    for (const std::int64_t number :
         {std::int64_t{1}, data.points, std::int64_t{1}, std::int64_t{1},
          static_cast<std::int64_t>(data.arrays.size()),
          std::int64_t{areLabels ? kMghInt : kMghFloat}}) {
        sink.bigEndian(static_cast<std::int32_t>(number));
    }
    sink << std::string(kHeader - 6 * sizeof(std::int32_t), '\0');
    for (const PointValues& frame : data.arrays) {
        std::visit(
            [&](const auto& values) {
                for (const auto value : values) sink.bigEndian(value);
            },
            frame.values);
    }
}

}  // namespace
}  // namespace adaptiso::meshio

namespace adaptiso {

namespace {

using meshio::ByteSource;
using meshio::damaged;

constexpr std::string_view kCurvMagic = "\xFF\xFF\xFF";
constexpr auto kBig = std::endian::big;

std::int64_t int24(ByteSource& source) {
    std::int64_t value = 0;
    for (int n = 0; n < 3; ++n) value = value << 8 | source.number<std::uint8_t>(kBig);
    return value;
}

PointData decodeCurv(std::string_view bytes) {
    ByteSource source(bytes);
    PointData data;
    data.format = PointDataFormat::FreeSurferCurv;
    std::vector<float> values;
    if (bytes.starts_with(kCurvMagic)) {
        source.take(kCurvMagic.size());
        data.points = source.number<std::int32_t>(kBig);
        source.number<std::int32_t>(kBig);  // triangles
        const auto each = source.number<std::int32_t>(kBig);
        if (each != 1) {
            meshio::unsupported("it holds " + std::to_string(each) + " values for each point",
                                "save one a file");
        }
        meshio::requireRoom("values", data.points, sizeof(float), source.left());
        for (std::int64_t i = 0; i < data.points; ++i) {
            values.push_back(source.number<float>(kBig));
        }
        meshio::requireNoMore({"values", data.points, sizeof(float)}, source.rest(), data.warnings);
    } else {
        data.points = int24(source);
        int24(source);  // triangles
        if (source.left() != static_cast<std::size_t>(data.points) * sizeof(std::int16_t)) {
            damaged("it does not begin with FF FF FF as FreeSurfer's values at points do");
        }
        constexpr float kUnit = 100;
        for (std::int64_t i = 0; i < data.points; ++i) {
            values.push_back(source.number<std::int16_t>(kBig) / kUnit);
        }
    }
    data.arrays.push_back({{}, std::move(values), 1, {}});
    return data;
}

void encodeCurv(const PointData& data, std::int64_t triangles, ByteSink& sink) {
    sink << kCurvMagic;
    for (const std::int64_t number : {data.points, triangles, std::int64_t{1}}) {
        sink.bigEndian(static_cast<std::int32_t>(number));
    }
    for (const float value : std::get<std::vector<float>>(data.arrays.front().values)) {
        sink.bigEndian(value);
    }
}

/// Passes over a text with its length before it.
void skipText(ByteSource& source) {
    const std::int64_t length = source.number<std::int32_t>(kBig);
    meshio::requireRoom("characters", length, 1, source.left());
    source.take(static_cast<std::size_t>(length));
}

/// Damage unless the table is whole. \return  the bytes behind it
std::string_view requireTable(std::string_view table) {
    ByteSource source(table);
    if (source.atEnd() || source.number<std::int32_t>(kBig) == 0) return source.rest();
    constexpr std::size_t kChannels = 4 * sizeof(std::int32_t);
    std::int64_t entries = source.number<std::int32_t>(kBig);
    const bool isOld = entries > 0;
    if (!isOld && entries != -2) damaged("its table of labels is of an unknown version");
    if (!isOld) source.number<std::int32_t>(kBig);  // the largest label, and one
    skipText(source);                               // the file that it is from
    if (!isOld) entries = source.number<std::int32_t>(kBig);
    const std::size_t least = kChannels + (isOld ? 1 : 2) * sizeof(std::int32_t);
    meshio::requireRoom("labels", entries, static_cast<std::int64_t>(least), source.left());
    for (std::int64_t n = 0; n < entries; ++n) {
        if (!isOld) source.number<std::int32_t>(kBig);  // the label's place in the table
        skipText(source);
        source.take(kChannels);
    }
    return source.rest();
}

PointData decodeAnnot(std::string_view bytes) {
    ByteSource source(bytes);
    PointData data;
    data.format = PointDataFormat::FreeSurferAnnot;
    data.points = source.number<std::int32_t>(kBig);
    meshio::requireRoom("labels", data.points, 2 * sizeof(std::int32_t), source.left());
    std::vector<std::int32_t> labels(static_cast<std::size_t>(data.points));
    std::vector<bool> isLabelled(labels.size());
    for (std::int64_t i = 0; i < data.points; ++i) {
        const std::int64_t point = source.number<std::int32_t>(kBig);
        if (point < 0 || point >= data.points) {
            damaged("it has a label for the point " + std::to_string(point) + " of " +
                    std::to_string(data.points));
        }
        if (isLabelled[static_cast<std::size_t>(point)]) {
            damaged("it has two labels for the point " + std::to_string(point));
        }
        isLabelled[static_cast<std::size_t>(point)] = true;
        labels[static_cast<std::size_t>(point)] = source.number<std::int32_t>(kBig);
    }
    meshio::requireNoMore({"labels", data.points, 2 * sizeof(std::int32_t)},
                          requireTable(source.rest()), data.warnings);
    data.annotTable = source.rest();
    data.arrays.push_back({{}, std::move(labels), 1, {}});
    return data;
}

void encodeAnnot(const PointData& data, std::int64_t, ByteSink& sink) {
    sink.bigEndian(static_cast<std::int32_t>(data.points));
    std::int32_t point = 0;
    for (const std::int32_t label :
         std::get<std::vector<std::int32_t>>(data.arrays.front().values)) {
        sink.bigEndian(point++);
        sink.bigEndian(label);
    }
    sink << data.annotTable;
}

/// The fault of data to be written, or just read; may be empty.
std::string faultOf(const PointData& data) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (data.points < 1) return "it holds no values";
    if (data.points > kMost)
        return "it holds values for more than " + std::to_string(kMost) + " points";
    for (const PointValues& array : data.arrays) {
        const auto size = [](const auto& values) { return std::ssize(values); };
        const std::int64_t count = std::visit(size, array.values);
        if (array.columns < 1 || count / array.columns != data.points ||
            count % array.columns != 0) {
            return "it has " + std::to_string(count) + " values for " +
                   std::to_string(data.points) + " points";
        }
    }
    return {};
}

void requireWritable(const PointData& data, const std::string& file) {
    const bool isGifti = data.format == PointDataFormat::Gifti;
    const bool wantsLabels = data.format == PointDataFormat::FreeSurferAnnot;
    const auto refuse = [&](const std::string& what) { throw InvalidInput(file + ": " + what); };
    if (data.arrays.empty()) refuse("there are no values to write");
    if (const std::string fault = faultOf(data); !fault.empty()) refuse(fault);
    if (isGifti) return;
    const PointValues& first = data.arrays.front();
    if (data.format == PointDataFormat::FreeSurferMgh) {
        for (const PointValues& array : data.arrays) {
            if (array.columns != 1 || array.areLabels() != first.areLabels()) {
                refuse("FreeSurfer mgh files hold numbers or labels, one a point and frame");
            }
        }
        return;
    }
    if (data.arrays.size() != 1 || first.columns != 1 || first.areLabels() != wantsLabels) {
        refuse(std::string(toString(data.format)) + " files hold one " +
               (wantsLabels ? "label" : "number") + " a point");
    }
    if (!wantsLabels) return;
    try {
        requireTable(data.annotTable);
    } catch (const FileError& error) {
        refuse(error.what());
    }
}

/// How a format is named, read and written; in the order of PointDataFormat.
struct PointDataCodec {
    std::string_view name;
    PointData (*decode)(std::string_view);
    void (*encode)(const PointData&, std::int64_t triangles, ByteSink&);
};
constexpr PointDataCodec kPointDataCodecs[] = {
    {"FreeSurfer curv", decodeCurv, encodeCurv},
    {"FreeSurfer annot", decodeAnnot, encodeAnnot},
    {"FreeSurfer mgh", meshio::decodeMghData, meshio::encodeMghData},
    {"GIFTI", meshio::decodeGiftiData, meshio::encodeGiftiData}};

const PointDataCodec& codecOf(PointDataFormat format) {
    return kPointDataCodecs[static_cast<std::size_t>(format)];
}

/// Advice for a file that has values at points in a form that is not read; empty: it may be
/// one that is.
std::string adviceFor(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    if (extension == ".mgz") return "is packed; unpack it to .mgh (mri_convert, or gzip -dc)";
    if (extension == ".label") {
        return "lists points, and has no value for each; make an .annot of it (mris_label2annot)";
    }
    if (extension == ".nii") {
        return "CIFTI and NIfTI files are not read; make a .shape.gii, .func.gii or .label.gii of "
               "it (wb_command -cifti-separate)";
    }
    return {};
}

}  // namespace

std::string_view toString(PointDataFormat format) {
    return codecOf(format).name;
}

PointDataFormat findPointDataFormat(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    if (extension == ".gii") return PointDataFormat::Gifti;
    if (extension == ".annot") return PointDataFormat::FreeSurferAnnot;
    if (extension == ".mgh") return PointDataFormat::FreeSurferMgh;
    return PointDataFormat::FreeSurferCurv;
}

PointData decodePointData(std::string_view bytes, PointDataFormat format, std::string_view name) {
    return meshio::naming(name, [&] {
        PointData data = codecOf(format).decode(bytes);
        if (const std::string fault = faultOf(data); !fault.empty()) damaged(fault);
        return data;
    });
}

PointData readPointData(const std::filesystem::path& path) {
    if (const std::string advice = adviceFor(path); !advice.empty()) {
        throw FileError(path.string() + ": " + advice);
    }
    return decodePointData(meshio::readBytes(path), findPointDataFormat(path), path.string());
}

void writePointData(const PointData& data, std::int64_t triangles,
                    const std::filesystem::path& path) {
    requireWritable(data, path.string());
    writeBytes(path, [&](ByteSink& sink) { codecOf(data.format).encode(data, triangles, sink); });
}

}  // namespace adaptiso
