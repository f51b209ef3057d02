#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Farther than this from all that the image shows counts as this far, mm.
inline constexpr double kFarFromSeenMm = 10;
/// Largest distance to an edge in the image that counts as seen: a voxel, smoothing, triangles; mm.
inline constexpr double kSeenWithinMm = 3;

/// How much of a surface follows what the image shows.
struct SeenSurface {
    std::vector<double>
        distanceMm;    ///< of each vertex from the nearest place seen, at most kFarFromSeenMm
    double share = 0;  ///< of the area, within kSeenWithinMm of such places
};

/// \param placesMm  where the image shows the surface (HeadBoundaries::seen); LPS mm
/// Cost: O(vertices + places) for places spread as voxels are.
SeenSurface seenOf(const TriangleMesh& surface, const std::vector<Vec3>& placesMm);

}  // namespace adaptiso
