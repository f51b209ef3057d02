#pragma once

#include <cstdint>
#include <limits>
#include <optional>

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
class PatchRound {
public:
    PatchRound(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame);

    /// Once.
    /// \param costs  gets those of the collapses, patch by patch; may be null
    void run(const PatchWork& work, CollapseCosts* costs = nullptr);

private:
    void lendSamples(Patch& patch) const;

    SimplifiedSurface& surface_;
    const MetricFrame& frame_;
    std::optional<PatchGroups> groups_;  ///< none after run()
};

}  // namespace adaptiso::detail
