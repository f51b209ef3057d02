#pragma once

#include "ImageSteps.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::headmodel {

/// The voxels whose centre lies inside a surface, by majority of its winding (or, where it is not
/// oriented, parity) along rows in three directions. Rows that don't come out as they went in,
/// because they pass a hole, have no vote.
/// \param surface  outward; may have holes, crossings, stray pieces, turned triangles
/// \pre triangles name points that are there and finite
Mask voxelized(const TriangleMesh& surface, const ImageGeometry& grid);

}  // namespace adaptiso::headmodel
