#pragma once

#include "Common/Progress.h"
#include "LabelsRun.h"
#include "Regions.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// Checks what adaptiso-labels promises by code that has no part in making it (MeshQuality), and
/// keeps the answers in run.checks:
///   - every region has a surface that is closed, outward, 2-manifold, without degenerate triangle,
///     of the Euler characteristic and the number of pieces that were measured;
///   - every wall lies between two regions, and in the surfaces of both;
///   - no two triangles of the whole complex cross;
///   - every voxel centre lies in the region of its label.
/// \param map  with merged labels
void checkComplex(const LabelComplex& complex, const RegionSurfaces& surfaces,
                  const VolumeView& map, LabelsRun& run, ProgressLine& progress);

}  // namespace adaptiso
