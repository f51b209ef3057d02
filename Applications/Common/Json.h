#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Resources.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Json/Json.h"  // IWYU pragma: export

namespace adaptiso {

/// The last part of a path, never a folder above it; of "." the folder's own name.
inline std::string baseName(const std::filesystem::path& path) {
    std::error_code error;
    if (path.has_filename() && path != "." && path != "..") return path.filename().string();
    return std::filesystem::canonical(path, error).filename().string();
}

/// `reportFailure`: why there is no page, though one is asked for; null when nothing failed.
inline Json reportFailureJson(const std::string& failure) {
    return failure.empty() ? Json(nullptr) : Json(failure);
}

/// "ras" and so on, or null where the frame is not known.
inline Json frameJson(const std::optional<CoordinateFrame>& frame) {
    return frame ? Json(frameWord(*frame)) : Json(nullptr);
}

/// `inputCoordinates` of a report's options: words as given; an empty list: as the files say.
inline Json inputCoordinatesJson(const std::vector<CoordinateFrame>& stated) {
    Json words = Json::array();
    for (const CoordinateFrame frame : stated) words.push_back(frameWord(frame));
    return words;
}

/// `seconds` of a report: every stage, and their total.
inline Json secondsJson(const StageTimer& timer) {
    Json seconds = Json::object();
    for (const auto& [stage, time] : timer.stages()) seconds[stage] = time;
    seconds["total"] = timer.total();
    return seconds;
}

}  // namespace adaptiso
