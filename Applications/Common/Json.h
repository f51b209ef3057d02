#pragma once

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "Common/Resources.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Keeps keys in the order they are written, as the READMEs list them.
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

/// The last part of a path, never a folder above it; of "." the folder's own name.
inline std::string baseName(const std::filesystem::path& path) {
    std::error_code error;
    if (path.has_filename() && path != "." && path != "..") return path.filename().string();
    return std::filesystem::canonical(path, error).filename().string();
}

/// As --coordinates takes it.
inline std::string_view frameWord(CoordinateFrame frame) {
    switch (frame) {
        case CoordinateFrame::Ras:
            return "ras";
        case CoordinateFrame::Lps:
            return "lps";
        case CoordinateFrame::TkRas:
            return "tkras";
        case CoordinateFrame::Voxel:
            return "voxel";
    }
    throw InternalError("frameWord: unknown coordinate frame");
}

/// `reportFailure`: why there is no page, though one is asked for; null when nothing failed.
inline Json reportFailureJson(const std::string& failure) {
    return failure.empty() ? Json(nullptr) : Json(failure);
}

/// `seconds` of a report: every stage, and their total.
inline Json secondsJson(const StageTimer& timer) {
    Json seconds = Json::object();
    for (const auto& [stage, time] : timer.stages()) seconds[stage] = time;
    seconds["total"] = timer.total();
    return seconds;
}

}  // namespace adaptiso
