#pragma once

#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::detail {

/// The methods that cover the surface with simple boxes. Boxes, the thesis's: cubic ones, iso-line
/// loops where resolutions meet, merged facets of discretized marching cubes elsewhere.
/// Discretized marching cubes [Montani1994] is the same with unit boxes, which are never shared.
/// SkeletonClimbing [Poston1998]: rectangular ones, iso-line loops everywhere. The blocks are the
/// grid's that the isovalue touches; the rest is as in extractSurface.
Extraction extractBoxes(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                        const ExtractionOptions& options);

}  // namespace adaptiso::detail
