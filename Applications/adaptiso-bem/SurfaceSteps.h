#pragma once

#include <vector>

#include "BemRun.h"
#include "Common/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// The dense surface of every solid, by marching cubes. Fills the run's surfaces.
std::vector<TriangleMesh> extractSurfaces(const HeadBoundaries& boundaries, BemRun& run,
                                          ProgressLine& progress);

/// Near-equilateral triangles, as many as asked for, then nested with the gaps asked for.
/// \return  the model's surfaces; empty when the run got findings
std::vector<TriangleMesh> remeshAndNest(const std::vector<TriangleMesh>& dense, BemRun& run,
                                        ProgressLine& progress);

}  // namespace adaptiso
