#pragma once

#include <limits>
#include <optional>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// An interval is to be no wider than the larger of a part of the distance and a part of the size,
/// the diagonal of the larger surface's box.
struct HausdorffOptions {
    double partOfDistance = 1e-3;
    double partOfSize = 1e-6;
    /// A limit to judge by: where it lies within an interval as wide as that, the upper end is
    /// brought below it, if it can be.
    std::optional<double> limitMm;
    bool isSymmetric = true;             ///< B to A too
    std::optional<Vec3> farOnA, farOnB;  ///< points of the surfaces that are known to lie far away
    ProgressCallback progress{};         ///< called when a direction is done; may be empty
};

/// Encloses the largest distance of a surface's points from another surface.
struct HausdorffInterval {
    double lowerMm = 0;                                        ///< a point lies as far away
    double upperMm = std::numeric_limits<double>::infinity();  ///< no point lies farther
    double toleranceMm = 0;   ///< width that was asked for, see HausdorffOptions
    bool isComplete = false;  ///< it is no wider
    Vec3 pointMm;             ///< lies lowerMm away, or more
    Vec3 nearestMm;           ///< its nearest point on the other surface, to rounding
};

struct HausdorffReport {
    HausdorffInterval aToB;
    std::optional<HausdorffInterval> bToA;  ///< empty unless options.isSymmetric
    HausdorffInterval combined;             ///< of the larger of both
};

/// Encloses the Hausdorff distance of two surfaces: of all their points, not of samples.
///
/// The distance to a triangle is a convex function: if the corners of a piece lie within d of one
/// and the same triangle, all of the piece does. A piece whose corners are near different triangles
/// is cut where an edge is as far from the one as from the other. Pieces within the tolerance of
/// the largest distance found are done with: branch and bound, as in [Tang2009], who halve
/// triangles. Rounding is included in both ends. Any triangles will
/// do: open, crossing, without area.
///
/// Where very many triangles lie about as far from each point, as where thousands cross each other,
/// the search ends early: the interval is wider then (isComplete is false), and holds. The budget
/// is 2^22 triangles to look at, and 512 for each of both surfaces; where some triangles, evenly
/// spread, show that it would not do, the others are bounded by the triangles nearest to their
/// vertices.
/// \pre  both have a triangle; triangles name points that are there and finite
///       \throws InvalidInput otherwise
/// Cost: O((T + cuts) log T), in parallel; 40 bytes a vertex besides an AabbTree. The same surfaces
/// give the same bytes, whatever the number of threads.
HausdorffReport hausdorffDistance(const TriangleMesh& a, const TriangleMesh& b,
                                  const HausdorffOptions& options = {});

}  // namespace adaptiso
