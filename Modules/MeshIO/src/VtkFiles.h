#pragma once

// Shared by both of VTK's formats: the texts they hold, and numbers by their types.

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "Codecs.h"

namespace adaptiso::meshio {

inline constexpr std::string_view kFrameFieldName = "CoordinateFrame";
inline constexpr std::string_view kSlicerFieldName = "SPACE";
inline constexpr std::string_view kNormalsName = "Normals";
inline constexpr std::string_view kToPolyData =
    "save the surface as PolyData, e.g. with ParaView's Extract Surface";

/// Names and texts of field data: the frame, unless the file is not to say it, and the version of
/// these files.
inline std::vector<std::pair<std::string_view, std::string_view>> fieldsOf(
    const MeshWriteOptions& options) {
    std::vector<std::pair<std::string_view, std::string_view>> fields;
    if (options.saysFrame) fields.emplace_back(kFrameFieldName, toString(options.frame));
    fields.emplace_back("AdaptisoSurfaceVersion", "1");
    return fields;
}

/// Adds the frame that a string array of field data names.
inline void addField(std::string_view name, std::string_view text, FrameMarks& marks) {
    if (name == kFrameFieldName) marks.add(parseCoordinateFrame(text));
    if (name != kSlicerFieldName) return;
    for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps}) {
        if (text == slicerName(frame)) marks.add(frame);
    }
}

/// The names of arrays in a file that holds each name once, and the normals under theirs.
template <class Array>
std::vector<std::string> arrayNames(const std::vector<Array>& arrays) {
    TakenNames taken({std::string(kNormalsName)});
    std::vector<std::string> names;
    names.reserve(arrays.size());
    for (const Array& array : arrays) {
        names.push_back(taken.unused(array.name.empty() ? "values" : array.name));
    }
    return names;
}

/// An array of points as files hold it: three bytes are a colour each.
inline PointArray wholeArray(std::string name, PixelType type, std::int64_t components,
                             std::vector<std::int64_t> numbers) {
    PointArray array{std::move(name), {}, static_cast<int>(components)};
    if (type != PixelType::UInt8 || components != 3) {
        array.values = std::move(numbers);
        return array;
    }
    std::vector<Color> colors(numbers.size() / 3);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const bool isShade = numbers[i] >= 0 && numbers[i] <= 255;
        colors[i / 3][i % 3] = isShade ? static_cast<std::uint8_t>(numbers[i]) : std::uint8_t{0};
    }
    array.components = 1;
    array.values = std::move(colors);
    return array;
}

/// Names of a number's type in the two formats.
struct NumberType {
    std::string_view inXml, inLegacy;
};

template <class T>
constexpr NumberType numberType() {
    if constexpr (std::is_same_v<T, double>) return {"Float64", "double"};
    if constexpr (std::is_same_v<T, float>) return {"Float32", "float"};
    if constexpr (std::is_same_v<T, std::int64_t>) return {"Int64", "vtktypeint64"};
    if constexpr (std::is_same_v<T, std::uint64_t>) return {"UInt64", "vtktypeuint64"};
    if constexpr (std::is_same_v<T, std::int32_t>) return {"Int32", "int"};
    if constexpr (std::is_same_v<T, std::uint8_t>) return {"UInt8", "unsigned_char"};
}

/// Calls f(number) for each number of `rows`: of points, normals, colours, triangles or numbers.
template <class Row, class F>
void forEachNumber(const std::vector<Row>& rows, const F& f) {
    for (const Row& row : rows) {
        if constexpr (std::is_arithmetic_v<Row>) {
            f(row);
        } else if constexpr (requires { row.x; }) {
            f(row.x);
            f(row.y);
            f(row.z);
        } else {
            for (const auto number : row) f(number);
        }
    }
}

/// The type of the numbers of a row.
template <class Row>
auto numberOf(const Row& row) {
    if constexpr (std::is_arithmetic_v<Row>) {
        return row;
    } else if constexpr (requires { row.x; }) {
        return row.x;
    } else {
        return row[0];
    }
}
template <class Row>
using NumberOf = decltype(numberOf(std::declval<Row>()));

/// Numbers in a row of an array; `components` for a plain list.
template <class Row>
constexpr int rowComponents(int components) {
    return std::is_arithmetic_v<Row> ? components : 3;
}

}  // namespace adaptiso::meshio
