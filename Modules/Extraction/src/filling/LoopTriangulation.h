#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Extraction/detail/PlanarTriangulation.h"

namespace adaptiso::detail {

/// A corner of a loop in space.
struct SpatialCorner {
    Vec3 point;
    Vec3 normal;             ///< of the surface there, or zero
    std::uint8_t faces = 0;  ///< bit f: lies on face f of the loop's box
};

/// Fills a loop in space with n - 2 triangles by cutting ears [Poston1998]: an ear is taken while
/// its normal lies within 15 degrees of the mean surface normal at its corners, the limit relaxed
/// by steps when no ear is left; among those the shortest chord. A chord between two corners on
/// one face of the box would lie in the neighbour box as well, and is taken last.
///
/// Appends to `out` by corner numbers, in the loop's sense. Corners may not fall together.
/// Cost: O(n^2) for n corners.
void triangulateLoop(std::span<const SpatialCorner> loop, std::vector<LocalTriangle>& out);

}  // namespace adaptiso::detail
