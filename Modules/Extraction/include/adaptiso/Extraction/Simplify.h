#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/SimplifyAims.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/AdaptiveWork.h"

namespace adaptiso {

/// Aims of simplify(). Lengths are in the mesh's own unit, which need not be the millimetre:
/// nothing depends on the scale. \pre maxErrorMm > 0, at least 1e-12 of the mesh's diagonal
struct SimplifyOptions : SimplifyAims {
    /// Vertices on open borders stay, bit by bit.
    bool keepBorders = false;
    /// Vertices at one place become one first.
    bool weld = false;
    ProgressCallback progress;  ///< called as the work goes on; may be empty
};

/// --keep-borders, --weld
const Options<SimplifyOptions>& simplifyOptions();

/// Facts found about the input, and the bound proved for the result.
struct SimplifyStatistics {
    /// The input's triangles without area: dropped. If a corner lies on the opposite side, the one
    /// across it is split there; if two corners lie next to each other, they become one, so
    /// that the surface does not open.
    std::int64_t degenerateTriangles = 0;
    std::int64_t duplicateTriangles = 0;  ///< of the input, with the corners of another, the same
                                          ///< way round: dropped
    std::int64_t borderEdges = 0;         ///< of the input: with one triangle
    /// Vertices of the input at edges with three triangles or more, or with two that face opposite
    /// sides, and those that join triangles by themselves alone: kept as they are.
    std::vector<std::int64_t> nonManifoldVertices;
    std::vector<std::int64_t> crossingTriangles;  ///< of the input, that cross others: kept
    /// Others of the input that lie near too many to be tested with all: kept as well.
    std::vector<std::int64_t> undecidedTriangles;
    /// The proved bound of the distance between input and result, both ways.
    double errorBoundMm = 0;
    /// The count that maxTriangles and reduction ask for, where they do. The mesh has more
    /// triangles when the bound (maxErrorMm), the surface's topology or what is kept does not allow
    /// as few.
    std::optional<std::int64_t> wantedTriangles;
    AdaptiveWork work;
};

struct Simplified {
    TriangleMesh mesh;
    SimplifyStatistics statistics;
};

/// A mesh with fewer triangles, the adaptive method's on any triangle mesh: quadric edge collapse
/// [Garland1997], each held by samples of the input, with the distance proved at the end.
///
/// A closed oriented 2-manifold that does not cross itself stays one, with the same components,
/// nested as they were, and genus. Open borders stay open, within the bound. Where the input is no
/// manifold, or crosses itself, it is kept as it is, and nothing new crosses. Triangles without
/// area and doubled ones are dropped (the bound is of the others); so are vertices that no triangle
/// uses. Normals are interpolated where the input has them.
///
/// \pre  the mesh has a triangle; indices are in range, coordinates finite; one aim at least is
///       given, and all are in range   \throws InvalidInput otherwise
/// The same input gives the same bytes, whatever the number of threads.
Simplified simplify(const TriangleMesh& mesh, const SimplifyOptions& options);

/// A point of a surface: a triangle and the weights of its corners, which add up to 1.
struct SurfacePoint {
    std::int64_t triangle = 0;
    std::array<double, 3> weight{};
};

/// For each point of `mesh` the nearest one of `onto`: where values at the vertices of a surface
/// are to be read for a simplified one.
/// \pre  `onto` has a triangle, coordinates are finite   \throws InvalidInput otherwise
std::vector<SurfacePoint> nearestPoints(const TriangleMesh& mesh, const TriangleMesh& onto);

}  // namespace adaptiso
