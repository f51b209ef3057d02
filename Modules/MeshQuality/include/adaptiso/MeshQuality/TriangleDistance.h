#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Two points, one of each of two triangles, that lie nearest to each other.
struct NearestPoints {
    double distanceMm = std::numeric_limits<double>::infinity();
    Vec3 pointA, pointB;
};

/// The smallest distance of two triangles, to rounding: corners to faces, sides to sides, and sides
/// through faces. Exactly 0 where trianglesMeet; then the points are one that both have.
/// \pre corners are finite
NearestPoints triangleDistance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// The gap between two surfaces: where they come nearest.
struct SurfaceGap {
    NearestPoints nearest;        ///< infinitely far when a surface has no triangle
    std::int64_t triangleA = -1;  ///< the first such pair
    std::int64_t triangleB = -1;
};

/// The smallest distance of two surfaces, over all pairs of their triangles (not of vertices or
/// samples). Triangles with a corner that is not finite are left out.
/// \param treeA, treeB  of `a` and `b`
/// Cost: O(T log T + pairs of triangles that boxes alone can't tell from the nearest), in parallel:
/// seven microseconds a triangle where the gap is as wide everywhere. The same surfaces give the
/// same answer, whatever the number of threads.
SurfaceGap surfaceGap(const TriangleMesh& a, const AabbTree& treeA, const TriangleMesh& b,
                      const AabbTree& treeB);

}  // namespace adaptiso
