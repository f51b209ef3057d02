#pragma once

#include <cstdint>
#include <string>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// Distances measured between a surface and the one that it was made from.
struct Verification {
    std::int64_t samples = 0;  ///< points at which distances were measured, both ways
    double maxMm = 0;          ///< the largest of them
};

/// Same components and holes, as far as their numbers say.
bool hasSameShape(const TopologyReport& a, const TopologyReport& b);

/// Checks the largest distance that was measured between a surface and `original`, in one direction
/// or both, against a bound, but for the rounding of coordinates and distances.
/// \param name  of what it was measured from: "the input"
/// \throws InternalError  "a point lies 0.3 mm from the input, not 0.2", after `begin`
void requireWithin(double measuredMm, double boundMm, const TriangleMesh& surface,
                   const TriangleMesh& original, const std::string& name, const std::string& begin);

/// surfaceDistance() to verify by: from all vertices, and on each surface from 4 points for each
/// triangle of the larger one; 2,000 at least, 200,000 at most.
DistanceReport sampledDistance(const TriangleMesh& surface, const TriangleMesh& original,
                               bool isSymmetric = true);

/// Measures a surface that lies within `boundMm` of `original`, both ways.
/// \throws InternalError  as requireWithin()
Verification verifyDistance(const TriangleMesh& surface, const TriangleMesh& original,
                            double boundMm, const std::string& name, const std::string& begin);

}  // namespace adaptiso
