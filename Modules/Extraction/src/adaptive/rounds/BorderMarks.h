#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// The half-edges (3 t + corner) of a surface's open borders, ascending.
/// \param mayBeOnBorder  not 0 for each point of a border, and for few others
/// \pre no edge has more than two triangles
std::vector<std::uint64_t> openHalfEdges(const SurfaceState& surface,
                                         std::span<const std::uint8_t> mayBeOnBorder);

/// Makes open borders ready to be simplified: marks their points (those that have no mark of their
/// own) and samples, and gives the points the quadrics of planes along the border, upright to the
/// surface [Garland1997].
/// \pre points along the borders are those of the full-resolution surface
void markBorders(std::span<const std::uint64_t> halfEdges, SimplifiedSurface& surface);

}  // namespace adaptiso::detail
