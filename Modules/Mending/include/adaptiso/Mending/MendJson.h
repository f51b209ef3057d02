#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Warning.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/Mending/Mend.h"

namespace adaptiso {

/// Counts of the faults that mend() found, by key.
Json mendFaultsJson(const MendStatistics& statistics);
/// Those that there are: "3 open border edges".
std::vector<std::string> mendFaultTexts(const MendStatistics& statistics);

/// Lists of the places that the proved distances do not hold for, by key.
Json mendPlacesJson(const MendStatistics& statistics);
/// Those that there are: "2 holes closed, 31 mm2; the widest spans 4.2 mm, around 1, 2, 3".
std::vector<std::string> mendPlaceTexts(const MendStatistics& statistics);

/// Each of them, with its kind: "hole closed".
std::vector<std::pair<std::string, MendedPlace>> mendPlaces(const MendStatistics& statistics);

/// "parts-dropped", where what was too thin for the bound is more than a twentieth of the surface.
/// \param areaMm2  of the input
std::optional<Warning> mendWarning(const MendStatistics& statistics, double areaMm2,
                                   const std::string& file);

/// How far the two surfaces lie apart, but for what is listed.
std::string mendDistanceText(const MendStatistics& statistics, double roundingMm);

}  // namespace adaptiso
