#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/Finding.h"

namespace adaptiso {

struct EdgeLengthRange {
    double minimumMm = 0;
    double maximumMm = 0;
};

struct RemeshOptions {
    /// Vertices of the result, exactly; 0: as many as the edge lengths ask for.
    std::int64_t vertices = 642;
    /// Unset: edges of one length. Set: `minimumMm` where the surface bends by half a radian over
    /// that length or a neighbour comes as close, growing to `maximumMm`. With a number of vertices
    /// all lengths are then multiplied by whatever it takes to reach that number.
    std::optional<EdgeLengthRange> edgeLengthMm{};
    /// Surfaces not to come near with long edges; only looked at with edgeLengthMm.
    std::vector<const TriangleMesh*> neighbours{};
    /// The lengths wanted at the surface's vertices, where they are known (wantedEdgesMm()): saves
    /// what it takes to find them. Empty: they follow from edgeLengthMm.
    std::vector<double> wantedEdgesMm{};
    /// 0: vertices lie on the input. More: they may leave it by as much, to lie on a quadric fitted
    /// to the input within 3/4 of an edge length, which takes out the stairs of a binary volume.
    double fitMm = 0;
};

struct RemeshStatistics {
    double minimumEdgeMm = 0;
    double meanEdgeMm = 0;
    double maximumEdgeMm = 0;
    double minimumAngleDeg = 0;     ///< of all triangles
    double p5SmallestAngleDeg = 0;  ///< 5th percentile (nearest rank) of triangles' smallest angles
    double meanVertexDistanceMm = 0;  ///< of vertices from the input
    double maximumVertexDistanceMm = 0;
};

struct Remeshed {
    TriangleMesh mesh;  ///< empty when there are findings; no normals
    RemeshStatistics statistics;
    std::vector<Finding> findings;
};

/// Makes a surface of near-equilateral triangles of a dense one, fit for boundary elements.
///
/// Isotropic remeshing [Botsch2004]: edges are split, collapsed and flipped, vertices relaxed along
/// the surface and put back onto it. Edits keep the link condition [Dey1999] and turn no triangle
/// away from the surface. Then edges are split or collapsed one by one until the number of vertices
/// is the one asked for. Where the result crosses itself (sheets closer than its edges are long)
/// edges are made shorter there, at the cost of the rest, a few times.
///
/// \param surface  dense, e.g. from marching cubes; may have flat triangles.
/// \return  one closed component of genus 0, outward, without self-intersection, with the number
///          of vertices asked for; or findings that say where that can't be had.
/// \pre  surface is closed, oriented, manifold, one component of genus 0, outward, finite; vertices
///       is 0 or >= 12, and not 0 without edgeLengthMm; 0 < minimumMm <= maximumMm; fitMm >= 0;
///       wantedEdgesMm is empty or has a length above 0 for each vertex
///       \throws InvalidInput otherwise, with the place of a handle if there is one
/// Cost: O(T log T); about 300 bytes a triangle. The same input gives the same bytes, whatever the
/// number of threads.
Remeshed remeshForBem(const TriangleMesh& surface, const RemeshOptions& options = {});

/// The edge lengths that options.edgeLengthMm asks for, one for each vertex of the surface.
/// \pre as remeshForBem(), and options.edgeLengthMm is set
std::vector<double> wantedEdgesMm(const TriangleMesh& surface, const RemeshOptions& options);

/// How many vertices equilateral triangles of these lengths take, before anything is remeshed:
/// within some percent of what remeshForBem() gives when no number is wanted.
/// \pre one length for each vertex, all above 0
std::int64_t verticesForEdges(const TriangleMesh& surface, const std::vector<double>& edgesMm);

}  // namespace adaptiso
