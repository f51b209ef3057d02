#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {

/// Two vertices (a < b) that more than one edge joins, and the triangles at those edges.
struct CrowdedEdge {
    VertexId a, b;
    std::vector<std::uint64_t> triangles;
};
/// \pre every edge of the surface has a triangle on either side, or one at an open border
std::vector<CrowdedEdge> findCrowdedEdges(const TriangleMesh& mesh);

/// Room for `count` elements and what splitChords adds to a mesh: chords to split are few, and
/// without it the mesh would be copied for them.
constexpr std::size_t withSpare(std::size_t count) {
    return count + count / 256 + 16;
}

/// An edge between a and b, by the two triangles at it.
struct ChordToSplit {
    VertexId a, b;
    std::uint64_t first, second;
};
/// Halves every chord by a vertex at its middle; both its triangles become two.
void splitChords(TriangleMesh& mesh, const std::vector<ChordToSplit>& chords);

/// Moves vertices of flat triangles (lower than 1e-5 voxel) along their lattice edges, by
/// thousandths of an edge and never nearer to its ends than half of kHair, until none is flat.
/// \param edges  the lattice edge of each of the first vertices; others stay
/// \throws InternalError when a triangle stays flat
void spreadFlatTriangles(TriangleMesh& mesh, std::span<const EdgeKey> edges,
                         const ImageGeometry& geometry, std::int64_t latticeOffset);

/// Gives vertices without a normal that of the triangles around, weighted by area.
void completeNormals(TriangleMesh& mesh);

}  // namespace adaptiso::detail
