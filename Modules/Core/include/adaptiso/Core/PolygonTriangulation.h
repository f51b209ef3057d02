#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// Cuts a polygon in the plane into triangles of its own corners, by cutting ears off
/// [Meisters1975]: of all ears the one whose smallest angle is the largest.
///
/// The ring may touch itself, as two-way bridges to holes do: corners may be equal by position, and
/// edges may overlap in opposite directions. Signs are exact (orient2d()), so that no triangle has
/// an area of zero where the ring allows it: corners on a straight line become corners of triangles
/// on their other side. Two things do not allow it. A corner in the place of the one before it
/// costs one triangle of zero area, and a ring on one line has no others.
///
/// \param ring  n corners, counter-clockwise; finite, within the limits of orient2d()
/// \return      n - 2 counter-clockwise triangles of indices into `ring`, which cover it once.
///              Empty where n < 3 and where there are none: the ring is clockwise, crosses itself,
///              or pinches its inside to a width of zero (two parts that share a corner only, a
///              line out and back). The same ring gives the same triangles.
/// Cost:        O(n2) for common shapes, O(n3) at worst
std::vector<std::array<std::uint32_t, 3>> triangulatePolygon(std::span<const Point2> ring);

}  // namespace adaptiso
