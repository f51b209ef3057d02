#pragma once

#include <optional>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/FractionField.h"
#include "adaptiso/HeadModel/SegmentedSkull.h"

namespace adaptiso {

/// The spongy bone of a segmentation within the skull of a model: its voxels, smoothed by 0.7 of a
/// voxel of the working grid, as far as they lie `gapMm` and `roomVoxels` voxels of that grid from
/// both surfaces of the skull. In several pieces, as the segmentation has them. Empty where it has
/// none there. \param innerSkull, outerSkull  of the model, nested; LPS mm \param stepMm  side of
/// the grid's voxels; 0: as BoundaryOptions::stepMm
std::optional<FractionField> spongySolid(const SegmentedHead& head, const TriangleMesh& innerSkull,
                                         const TriangleMesh& outerSkull, double gapMm,
                                         double roomVoxels, double stepMm);

}  // namespace adaptiso
