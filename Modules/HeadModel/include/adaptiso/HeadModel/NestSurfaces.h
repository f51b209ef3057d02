#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/Finding.h"

namespace adaptiso {

/// Least thickness of skull or scalp in a model unless told otherwise. A third of what adults'
/// skulls have at the temples on average (6 mm; frontal, parietal, occipital 8 to 10)
/// [Calisan2021], so that it acts where bone is thin or a boundary errs; below, no usual number of
/// triangles resolves the layer.
inline constexpr double kDefaultMinGapMm = 2;

struct NestOptions {
    /// Least distance of surface n to surface n + 1, mm: one for each pair, or one for all.
    std::vector<double> minGapsMm{kDefaultMinGapMm};
    /// Stays where it is; those around it may move outward, those inside it inward. The inner
    /// skull: its inside holds the sources, and its distance to them is what potentials depend on
    /// most.
    std::size_t fixedSurface = 0;
    double maxMoveMm = 15;  ///< a vertex that would have to go further is a finding
};

/// Changes of one surface.
struct SurfaceMove {
    std::int64_t movedVertices = 0;
    double meanMm = 0;  ///< of those moved
    double maximumMm = 0;
    Vec3 maximumPointMm;  ///< where, before the move
};

/// The place where two neighbouring surfaces come nearest.
struct NestedGap {
    double mm = 0;
    Vec3 innerPointMm, outerPointMm;
};

struct NestResult {
    std::vector<TriangleMesh> surfaces;  ///< empty when there are findings; no normals if moved
    std::vector<SurfaceMove> moves;      ///< one a surface
    std::vector<NestedGap> gaps;         ///< one a pair; empty when there are findings
    std::vector<Finding> findings;       ///< why the surfaces can't be nested, and where
};

/// Makes each surface lie strictly inside the next, at least a stated distance away.
///
/// Only vertices near a violation move, along the shortest way out that the distance to the other
/// surface points (not from any centre, so ears, chin and neck are as good as spheres), and the
/// movement fades out over the neighbouring triangles. Surfaces that are well nested stay as they
/// are, to the bit. Triangles stay as they are in any case.
///
/// The result is checked, not believed: checkNesting() and findSelfIntersections() of what is
/// returned are exact but for rounding of distances.
///
/// \param surfaces  from the innermost to the outermost; mm, LPS
/// \return  nested surfaces without self-intersection, every gap at least as asked for; or
/// findings. \pre  one surface or more, each closed, oriented, manifold, one component, outward;
/// gaps > 0,
///       one or one a pair; fixedSurface names one; maxMoveMm > 0 \throws InvalidInput otherwise
/// Cost: O(T log T) for each of up to a hundred small moves. The same input gives the same bytes,
/// whatever the number of threads.
NestResult nestSurfaces(const std::vector<TriangleMesh>& surfaces, const NestOptions& options = {});

/// One closed, outward 2-manifold in one piece, without degenerate triangles: what nestSurfaces()
/// takes.
bool isOneSolid(const TriangleMesh& mesh);

/// A surface that was moved outward, where it had to be.
struct NestedAround {
    std::vector<Vec3> points;
    SurfaceMove move;
    NestedGap gap;
};

/// The points of `mesh`, moved until it lies around `fixed`, at least `gapMm` away everywhere: by
/// nestSurfaces(). \param fixed  as isOneSolid() has it \param gapMm  > 0
/// \throws InvalidInput  either is no such surface, or that can't be had; the message has the place
NestedAround nestAround(const TriangleMesh& mesh, const TriangleMesh& fixed, double gapMm);

}  // namespace adaptiso
