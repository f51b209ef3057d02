#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Keeps keys in the order they are written, as the programs' READMEs list them.
using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity: they become null.
inline Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

inline Json vector(const Vec3& v) {
    return {number(v.x), number(v.y), number(v.z)};
}

template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

/// `json` as a file has it; on one line where `indent` is -1. What is not UTF-8, as names of files
/// need not be, becomes U+FFFD. Characters that withoutControls() leaves out are escaped, and with
/// them all that are not ASCII.
std::string jsonText(const Json& json, int indent = 2);

/// {code, file, text}; `file` is null where the warning names none.
inline void to_json(Json& json, const Warning& warning) {
    json = {{"code", warning.code},
            {"file", warning.file.empty() ? Json(nullptr) : Json(warning.file)},
            {"text", warning.text}};
}

/// Reads what to_json() wrote. \throws Json::exception  for anything else
inline void from_json(const Json& json, Warning& warning) {
    json.at("code").get_to(warning.code);
    json.at("text").get_to(warning.text);
    if (const Json& file = json.at("file"); !file.is_null()) file.get_to(warning.file);
}

/// "ras", "lps", "tkras", "voxel": as --coordinates and the Python module take it.
std::string_view frameWord(CoordinateFrame frame);

/// An image's place, as the reports have it: sizeVoxels, spacingMm, originMm, direction (LPS mm).
Json geometryJson(const ImageGeometry& geometry);

}  // namespace adaptiso
