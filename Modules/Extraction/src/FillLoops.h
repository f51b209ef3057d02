#pragma once

#include "LatticeSampler.h"
#include "SurfaceLoops.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// Fills the loops with triangles and puts the vertices at their crossings (thesis 5.3): merged
/// facets on their planes, holes and all; iso-line loops and odd facets in space.
///
/// Chords that join two vertices already joined elsewhere are split at their middle, so that an
/// edge never has more than two triangles; corners that fall on a line are moved along their
/// lattice edges by a hair, so that no triangle is flat.
/// \param latticeOffset  lattice position of sample 0
/// \param edgesSplit     is told how many chords were split
template <class Id>
TriangleMesh fillLoops(SurfaceLoops<Id> loops, const LatticeSampler& sampler,
                       const ImageGeometry& geometry, std::int64_t latticeOffset,
                       std::int64_t& edgesSplit);

}  // namespace adaptiso::detail
