#pragma once

#include "adaptiso/Json/Json.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// How good the elements are, as the programs' reports have it: dihedralDeg (minimum, p5) and
/// radiusEdge (maximum, p95).
Json elementShapesJson(const TetrahedraReport& report);

}  // namespace adaptiso
