#pragma once

#include <cstdint>
#include <vector>

#include "DualComplex.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

struct Walls {
    LabelComplex complex;
    std::int64_t mendedCrossings = 0;  ///< polygons that were cut otherwise, as they crossed others
};

/// Cuts the polygons into triangles, none of which cross: along the shorter diagonal, along the
/// other one, or round a point on the polygon's lattice edge [JuUdeshi2006].
///
/// \param complex  its polygons and corners are taken
/// \param grid     its labels are not asked for
/// \param points   of the groups and the faces of the complex (lattice), each in its room; taken.
///                 The last of the three ways keeps each triangle in the rooms of its corners:
///                 always sound.
Walls cutPolygons(DualComplex&& complex, const LabelGrid& grid, std::vector<Vec3>&& points,
                  const ImageGeometry& geometry);

}  // namespace adaptiso::detail
