#pragma once

#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::detail {

/// Marching cubes [Lorensen1987] on the full grid, ambiguous faces decided alike from both cells
/// by the asymptotic decider [Nielson1991]; only the index's blocks are visited. The blocks are the
/// grid's that the isovalue touches; the rest is as in extractSurface.
Extraction extractMarchingCubes(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                                const ExtractionOptions& options);

}  // namespace adaptiso::detail
