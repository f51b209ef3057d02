#pragma once

#include <optional>

#include "MendInput.h"

namespace adaptiso::detail {

/// The border of the solid of a closed input whose triangles cross: all are cut along the lines
/// where they meet, and those parts kept that have the solid on one side alone. Rounding new points
/// to single precision may make others cross: these are cut again, a few times, and left then.
///
/// The solid is where the winding number is at least a half. What is dropped, and how far points
/// may have moved, is added to what was found.
/// \param box  of the used points
/// \return  none where triangles do not cross, or too often to be found, or the input is open
std::optional<MendInput> cutCrossings(const MendInput& input, const BoundingBox& box,
                                      MendStatistics& statistics);

}  // namespace adaptiso::detail
