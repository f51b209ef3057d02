#pragma once

#include "adaptiso/Core/TriangleMesh.h"
#include "lattice/LatticeSampler.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {

/// Where vertices lie on their lattice edges.
enum class VertexPlacement { Crossing, Midpoint };

/// Fills the loops with triangles and places the vertices (thesis 5.3): merged facets on their
/// planes, holes and all; iso-line loops and odd facets in space.
///
/// Chords that join two vertices already joined elsewhere are split at their middle, so that an
/// edge never has more than two triangles; crossings that fall on a line are moved along their
/// lattice edges by a hair, so that no triangle is flat. Midpoints of unit boxes' edges stay where
/// they are: facets are triangulated on their planes in midpoint coordinates, and no three
/// midpoints of one cell's edges lie on a line.
/// \param latticeOffset  lattice position of sample 0
/// \param edgesSplit     is told how many chords were split
/// \pre  with VertexPlacement::Midpoint, all boxes are unit boxes
template <class Id>
TriangleMesh fillLoops(SurfaceLoops<Id> loops, const LatticeSampler& sampler,
                       const ImageGeometry& geometry, std::int64_t latticeOffset,
                       VertexPlacement placement, std::int64_t& edgesSplit);

}  // namespace adaptiso::detail
