// FreeSurfer's files of values at points, big endian, as its MRISwriteCurvature and
// MRISwriteAnnotation and nibabel's write_morph_data and write_annot have them.
//   curv   FF FF FF, int32 points, triangles, 1; float32 values.
//          Before 2000: int24 points, triangles; int16 hundredths.
//   annot  int32 points; of each int32 number and int32 label (R + 256 G + 65536 B); then, where
//          int32 1 follows, a table of names and colours, in one of two versions.
#include "adaptiso/MeshIO/PointData.h"

#include <algorithm>
#include <limits>

#include "ByteSource.h"
#include "FileBytes.h"
#include "GiftiData.h"
#include "MghData.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using meshio::ByteSink;
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

/// Damage unless the table is whole. What may follow it is nobody's.
void requireTable(std::string_view table) {
    ByteSource source(table);
    if (source.atEnd() || source.number<std::int32_t>(kBig) == 0) return;
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
}

PointData decodeAnnot(std::string_view bytes) {
    ByteSource source(bytes);
    PointData data;
    data.format = PointDataFormat::FreeSurferAnnot;
    data.points = source.number<std::int32_t>(kBig);
    meshio::requireRoom("labels", data.points, 2 * sizeof(std::int32_t), source.left());
    std::vector<std::int32_t> labels(static_cast<std::size_t>(data.points));
    for (std::int64_t i = 0; i < data.points; ++i) {
        const std::int64_t point = source.number<std::int32_t>(kBig);
        if (point < 0 || point >= data.points) {
            damaged("it has a label for the point " + std::to_string(point) + " of " +
                    std::to_string(data.points));
        }
        labels[static_cast<std::size_t>(point)] = source.number<std::int32_t>(kBig);
    }
    requireTable(source.rest());
    data.annotTable = source.rest();
    data.arrays.push_back({{}, std::move(labels), 1, {}});
    return data;
}

void encodeAnnot(const PointData& data, ByteSink& sink) {
    sink.bigEndian(static_cast<std::int32_t>(data.points));
    std::int32_t point = 0;
    for (const std::int32_t label :
         std::get<std::vector<std::int32_t>>(data.arrays.front().values)) {
        sink.bigEndian(point++);
        sink.bigEndian(label);
    }
    sink << data.annotTable;
}

/// What is wrong with data to be written, or just read; empty: nothing.
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

PointData decode(std::string_view bytes, PointDataFormat format) {
    switch (format) {
        case PointDataFormat::FreeSurferCurv:
            return decodeCurv(bytes);
        case PointDataFormat::FreeSurferAnnot:
            return decodeAnnot(bytes);
        case PointDataFormat::FreeSurferMgh:
            return meshio::decodeMghData(bytes);
        case PointDataFormat::Gifti:
            return meshio::decodeGiftiData(bytes);
    }
    throw InternalError("decodePointData: unknown format of values at points");
}

/// What to do with a file that has values at points in a form that is not read; empty: it may be
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
    switch (format) {
        case PointDataFormat::FreeSurferCurv:
            return "FreeSurfer curv";
        case PointDataFormat::FreeSurferAnnot:
            return "FreeSurfer annot";
        case PointDataFormat::FreeSurferMgh:
            return "FreeSurfer mgh";
        case PointDataFormat::Gifti:
            return "GIFTI";
    }
    throw InternalError("toString: unknown format of values at points");
}

PointDataFormat findPointDataFormat(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    if (extension == ".gii") return PointDataFormat::Gifti;
    if (extension == ".annot") return PointDataFormat::FreeSurferAnnot;
    if (extension == ".mgh") return PointDataFormat::FreeSurferMgh;
    return PointDataFormat::FreeSurferCurv;
}

PointData decodePointData(std::string_view bytes, PointDataFormat format, std::string_view name) {
    const std::string prefix = std::string(name) + ": ";
    try {
        PointData data = decode(bytes, format);
        if (const std::string fault = faultOf(data); !fault.empty()) damaged(fault);
        return data;
    } catch (const FileError& error) {
        throw FileError(prefix + error.what());
    } catch (const std::bad_alloc&) {
        throw FileError(prefix + "it does not fit into memory; use a larger machine");
    }
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
    meshio::writeBytes(path, [&](ByteSink& sink) {
        switch (data.format) {
            case PointDataFormat::FreeSurferCurv:
                return encodeCurv(data, triangles, sink);
            case PointDataFormat::FreeSurferAnnot:
                return encodeAnnot(data, sink);
            case PointDataFormat::FreeSurferMgh:
                return meshio::encodeMghData(data, sink);
            case PointDataFormat::Gifti:
                return meshio::encodeGiftiData(data, sink);
        }
    });
}

}  // namespace adaptiso
