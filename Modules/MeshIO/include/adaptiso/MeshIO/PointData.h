#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// A kind of file that holds values at the points of a surface in another file.
enum class PointDataFormat {
    FreeSurferCurv,   ///< a number a point: lh.thickness, lh.curv, lh.sulc, lh.area, ...
    FreeSurferAnnot,  ///< a label a point and a table of names: lh.aparc.annot
    FreeSurferMgh,    ///< numbers, or labels, in one frame or several: lh.thickness.fsaverage.mgh
    Gifti             ///< .shape.gii, .func.gii, .label.gii
};

/// "FreeSurfer curv", "FreeSurfer annot", "FreeSurfer mgh", "GIFTI"
std::string_view toString(PointDataFormat format);

/// The format of a file, by its name alone: .gii, .annot, .mgh, and curv for all others.
PointDataFormat findPointDataFormat(const std::filesystem::path& path);

/// One array of values at points: numbers, or labels.
struct PointValues {
    /// GIFTI: what the numbers mean, "NIFTI_INTENT_SHAPE"; empty otherwise.
    std::string intent;
    std::variant<std::vector<float>, std::vector<std::int32_t>> values;
    std::int64_t columns = 1;  ///< numbers for each point, one after the other
    /// GIFTI: "Name" and the part of the brain.
    std::vector<std::pair<std::string, std::string>> metadata;

    bool areLabels() const { return std::holds_alternative<std::vector<std::int32_t>>(values); }
};

/// An entry of a GIFTI file's table of labels.
struct PointLabel {
    std::int32_t key = 0;
    std::string name;
    std::optional<std::array<double, 4>> rgba;  ///< 0 to 1
};

/// Content of a file of values at points.
struct PointData {
    PointDataFormat format{};
    std::int64_t points = 0;
    std::vector<PointValues> arrays;  ///< at least one; each with `points` x columns values
    std::vector<PointLabel> labels;   ///< GIFTI
    /// annot: its table, as stored, with all that follows the labels. It may be empty.
    std::string annotTable;
    std::vector<std::pair<std::string, std::string>> metadata;  ///< GIFTI: as of an array
    std::vector<Warning> warnings{};  ///< of reading; without the file's name
};

/// Reads values at points. Files are taken for hostile, as by readMesh(); control characters in
/// names become '?'. Of a GIFTI file's metadata only the names of arrays and AnatomicalStructure*
/// are kept: the rest may name people, places and dates.
///
/// curv: the form of 2000 and later (float32), and the older one (16 bits, hundredths).
/// mgh: float32, and int32, int16 and uint8, which are taken for labels; an array a frame. Its
/// header beyond that and all that follows the values are not kept. GIFTI: float32, int32 and uint8
/// arrays of a value, or several, for every point; sparse ones (NIFTI_INTENT_NODE_INDEX) are
/// refused. So are, by their names, .mgz and .label, and the .nii of CIFTI. \throws FileError
/// "<file>: what is wrong; what to do"
PointData readPointData(const std::filesystem::path& path);

/// The same from bytes in memory. \throws FileError  "<name>: what is wrong; what to do"
PointData decodePointData(std::string_view bytes, PointDataFormat format, std::string_view name);

/// Writes values at points: the same data give the same bytes.
/// \param triangles  of the surface: a curv file holds their number
/// \throws InvalidInput  no points or arrays, values that are not one a point and column, more than
///                       the format can count; curv: not one array of numbers; annot: not one of
///                       labels, or a table that is damaged; mgh: columns, or numbers beside labels
/// \throws FileError     the file can't be written
void writePointData(const PointData& data, std::int64_t triangles,
                    const std::filesystem::path& path);

}  // namespace adaptiso
