#pragma once

#include "adaptiso/Extraction/Extraction.h"
#include "lattice/ActiveBlocks.h"
#include "lattice/LatticeSampler.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {

/// The isosurface as iso-line loops on the faces of simple rectangular boxes, by adaptive skeleton
/// climbing [Poston1998]: SkeletonClimber's boxes; each face cut into the rectangles in which one
/// box of this side meets one of the other, in the block and beyond it, so that both sides walk
/// the same vertices.
///
/// \param statistics  is told the boxes, by longest side, and what their cells add up to
template <int N, class Id>
SurfaceLoops<Id> makeAscLoops(const LatticeSampler& sampler, const ActiveBlocks& active,
                              ExtractionStatistics& statistics);

}  // namespace adaptiso::detail
