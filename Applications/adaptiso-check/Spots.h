#pragma once

#include <vector>

#include "CheckRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// Where the checks that failed say to look: holes, crossings, what is not manifold, slivers, the
/// point farthest from the isosurface. Defects near each other are one spot; of many, the first.
/// \param mesh  of the surface, LPS mm
std::vector<ReportSpot> spotsOf(const SurfaceRun& surface, const TriangleMesh& mesh);

/// The same of two surfaces; the smallest gap is always told.
std::vector<ReportSpot> spotsOf(const NestingRun& pair, const std::string& innerName,
                                const std::string& outerName, const TriangleMesh& inner,
                                const TriangleMesh& outer);

}  // namespace adaptiso
