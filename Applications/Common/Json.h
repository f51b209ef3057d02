#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Naming.h"  // IWYU pragma: export
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Json/Json.h"         // IWYU pragma: export
#include "adaptiso/Json/SecondsJson.h"  // IWYU pragma: export

namespace adaptiso {

/// `reportFailure`: why there is no page, though one is asked for; null when nothing failed.
inline Json reportFailureJson(const std::string& failure) {
    return failure.empty() ? Json(nullptr) : Json(failure);
}

/// `result` of a report: what a batch, its records and its page take over.
/// \param says   in a few words
/// \param files  written under --output, as paths from the folder that holds it
inline Json resultJson(const std::string& says, const std::vector<std::string>& files = {}) {
    return {{"says", says}, {"files", files}};
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

}  // namespace adaptiso
