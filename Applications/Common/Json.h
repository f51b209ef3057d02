#pragma once

#include <filesystem>
#include <string>

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

/// `seconds` of a report: every stage, and their total.
inline Json secondsJson(const StageTimer& timer) {
    Json seconds = Json::object();
    for (const auto& [stage, time] : timer.stages()) seconds[stage] = time;
    seconds["total"] = timer.total();
    return seconds;
}

}  // namespace adaptiso
