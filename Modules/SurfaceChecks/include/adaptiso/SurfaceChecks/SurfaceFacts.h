#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/Duplicates.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Shape.h"
#include "adaptiso/MeshQuality/Size.h"
#include "adaptiso/MeshQuality/SolidAngle.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// All that is measured of one surface. What is required of it is another matter (Checks.h).
struct SurfaceFacts {
    TopologyReport topology;
    std::int64_t repeatedIndexTriangles = 0;  ///< of the degenerate ones, those that name a vertex
                                              ///< twice
    DuplicateReport duplicates;
    SelfIntersections intersections;
    Vec3 firstCrossingMm;  ///< the middle of the first triangle that crosses another
    ShapeReport shape;
    SizeReport size;
    SolidAngleCriterion solidAngle;
    /// Numbers of the pieces that are the wrong way round; none where that can't be told: the
    /// surface is open, not manifold, not oriented, or not finite.
    std::optional<std::vector<std::int64_t>> insideOut;
    double areaMm2 = 0;               ///< of the triangles with finite corners
    std::optional<double> volumeMm3;  ///< none unless closed, manifold and oriented

    /// Every triangle has its corners for itself, though they lie at places of others.
    bool isSoup() const;
};

/// Triangles of `mesh` that name points which aren't there are made to name one, added at the end,
/// that is not finite: no number of a triangle changes, and later measures leave them out.
/// \param maxPairs  of triangles that cross, to list
SurfaceFacts measureSurface(TriangleMesh& mesh, const SizeLimits& sizeLimits,
                            std::int64_t maxPairs);

}  // namespace adaptiso
