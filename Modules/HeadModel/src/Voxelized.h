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

/// The inside of such a surface as parts of voxels, by distance from the surface itself where it is
/// near the solid's. Tunnels that `closingMm` closes are filled. \throws InvalidInput  it encloses
/// nothing
std::vector<float> surfacePart(const TriangleMesh& surface, const ImageGeometry& grid,
                               double closingMm);

}  // namespace adaptiso::headmodel
