#pragma once

#include <cstdint>

#include "adaptiso/Json/Json.h"
#include "adaptiso/Labels/Labels.h"

// The numbers of label walls, as adaptiso-labels and the Python package report them.

namespace adaptiso {

/// The walls of a complex. \param errorBoundMm  of the file's points
Json wallsJson(std::int64_t points, std::int64_t triangles, double errorBoundMm,
               const LabelStatistics& statistics);

/// `begin`, which has the region's label, with its measures.
Json measureJson(Json begin, const RegionMeasure& measure);

}  // namespace adaptiso
