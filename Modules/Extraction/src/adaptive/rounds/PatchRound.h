#pragma once

#include <cstdint>
#include <limits>

#include "adaptive/collapse/PatchSimplifier.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/rounds/PatchGroups.h"

namespace adaptiso::detail {

/// Work of a round in every patch.
struct PatchWork {
    PatchLimits limits;
    bool collapses = true;
    /// Collapses to make in all patches together, or more than there can be.
    std::int64_t mostCollapses = std::numeric_limits<std::int64_t>::max() / 4;
    bool fits = false;
};

/// Works on the surface in the patches of a cut, side by side. Triangles that straddle two cubes
/// stay as they are.
/// \param costs  gets those of the collapses, patch by patch; may be null
void runPatchRound(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame,
                   const PatchWork& work, CollapseCosts* costs = nullptr);

}  // namespace adaptiso::detail
