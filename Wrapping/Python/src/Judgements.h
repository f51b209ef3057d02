#pragma once

#include <span>
#include <string>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso::python {

/// What adaptiso-check has in `surfaces` of one: verdict and facts.
Json surfaceVerdict(const TriangleMesh& mesh, const CheckRules& rules);

/// What adaptiso-check has of nested surfaces: passed, surfaces, nesting.pairs.
/// \param gapsMm  required of each pair; empty: rules.minGapMm of all
Json nestedJson(std::span<const TriangleMesh* const> meshes, std::span<const std::string> names,
                std::span<const double> gapsMm, const CheckRules& rules);

std::string dumped(const Json& json);

}  // namespace adaptiso::python
