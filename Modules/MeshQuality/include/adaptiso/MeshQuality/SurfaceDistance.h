#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"

namespace adaptiso {

struct DistanceOptions {
    std::int64_t samples = 200000;  ///< points on a surface, for each direction; >= 1
    bool isSymmetric = true;        ///< B to A too
    ProgressCallback progress{};    ///< called when a direction is done; may be empty
};

/// Distances of the points of one surface from another. Percentiles are by nearest rank: the
/// smallest value that at least that part of the samples does not exceed.
struct DistanceStatistics {
    std::int64_t samples = 0;  ///< points spread over the area
    double meanMm = 0;
    double rmsMm = 0;
    double p95Mm = 0;
    double p99Mm = 0;
    double maxMm = 0;      ///< of samples and vertices: never more than the truth, but for `rough`
    RoughDistances rough;  ///< points whose distance may be too large
    /// Samples for which a measured one stands, where distances to thousands of triangles that
    /// cross would have to be known: maxMm is that of the measured ones.
    std::int64_t leftOut = 0;
    std::int64_t leftOutVertices = 0;   ///< not measured either
    double meanErrorMm = 0;             ///< two standard errors of meanMm due to that
    Vec3 maxPointMm;                    ///< where, on the surface that is measured from
    double meanNormalDeviationDeg = 0;  ///< angle between the two surfaces' triangle normals
    double p95NormalDeviationDeg = 0;

    std::int64_t measured() const { return samples - leftOut; }
};

struct DistanceReport {
    DistanceStatistics aToB;
    DistanceStatistics bToA;  ///< zero samples unless options.isSymmetric
    /// Over the samples of all directions, as many from A as from B. Equals aToB unless
    /// options.isSymmetric.
    DistanceStatistics combined;
};

/// Distance between two surfaces, as the tool MESH measures it [Aspert2002]: points spread evenly
/// over the area of one, and their exact distance to the other.
///
/// Samples lie at equal steps of accumulated area, so that a triangle of n steps gets n samples
/// give or take one; within triangles they follow the R2 sequence [Roberts2018, a low-discrepancy
/// sequence of the plastic number]. There is no chance in it. Vertices count in the maximum only.
/// Departure from [Aspert2002], who lay a lattice on each triangle: however many small triangles
/// there are, the number of samples and the weight of an area stay the same.
/// \pre  both meshes have a triangle with area; triangles name points that are there and finite;
///       options.samples >= 1    \throws InvalidInput otherwise
/// Cost: O((T + samples + V) log T); about 64 bytes a sample besides an AabbTree and 8 bytes a
/// triangle. The same meshes give the same bytes, whatever the number of threads.
///
/// [Aspert2002] N. Aspert, D. Santa-Cruz, T. Ebrahimi, MESH: measuring errors between surfaces
/// using the Hausdorff distance, ICME 2002.
DistanceReport surfaceDistance(const TriangleMesh& a, const TriangleMesh& b,
                               const DistanceOptions& options = {});

/// Largest distance that surfaceDistance() measures from a mesh to itself, mm: the rounding of its
/// distances. It grows with the square of a triangle's length over its height.
double measuringErrorMm(const TriangleMesh& mesh);

/// The distance from each vertex of `from` to the surface `to`. \pre `to` has a triangle
std::vector<double> vertexDistancesMm(const TriangleMesh& from, const TriangleMesh& to);

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
    bool isComplete = true;  ///< false: hundreds of triangles lie about as far from each one, and
                             ///< some that are not looked at may lie nearer
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
