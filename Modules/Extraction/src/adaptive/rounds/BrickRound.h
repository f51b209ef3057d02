#pragma once

#include "adaptive/bricks/Bricks.h"
#include "adaptive/collapse/PatchSimplifier.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// The first round: meshes every brick and simplifies it alone. What lies on bricks' walls stays as
/// it is.
/// \param costs   gets those of each brick's collapses; may be null
/// \param moving  continuous sample indices: what lies outside stays too; null: nothing does
SimplifiedSurface simplifyBricks(const LatticeSampler& sampler, const Bricks& bricks,
                                 const MetricFrame& frame, const PatchLimits& limits,
                                 CollapseCosts* costs, const BoundingBox* moving = nullptr);

}  // namespace adaptiso::detail
