#pragma once

#include "Common/Json.h"
#include "GiantPlan.h"
#include "PieceJoiner.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What the page of --report tells and shows.
/// \param json    the report of the join
/// \param coarse  a copy of the surface that a browser can show, LPS mm
Report giantReport(const GiantPlan& plan, const GiantSurface& surface, const Json& json,
                   TriangleMesh coarse);

}  // namespace adaptiso
