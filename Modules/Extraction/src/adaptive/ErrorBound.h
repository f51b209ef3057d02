#pragma once

#include <memory>
#include <vector>

#include "BrickProof.h"
#include "Bricks.h"
#include "MetricFrame.h"
#include "SimplifiedSurface.h"
#include "SurfaceLookup.h"

namespace adaptiso::detail {

/// Bounds of the distance between the full-resolution surface and the simplified one, mm: no point
/// of the one is farther from the other.
struct ErrorBound {
    double fromFineMm = 0;  ///< points of the full-resolution surface
    double toFineMm = 0;    ///< points of the simplified surface
    std::vector<PlaceBeyond> beyondLimit;

    double largest() const { return fromFineMm > toFineMm ? fromFineMm : toFineMm; }
};

/// Proves bounds by going over both surfaces brick by brick, the full-resolution one made anew.
/// Nothing of what the simplification believed is trusted, except for where to look first.
class ErrorProof {
public:
    /// \param limitMm  what is farther than that is noted in ErrorBound::beyondLimit
    ErrorProof(const LatticeSampler& sampler, const Bricks& bricks, const MetricFrame& frame,
               double limitMm)
        : sampler_(sampler), bricks_(bricks), frame_(frame), limitMm_(limitMm) {}

    /// Bricks near which the surface has not changed since the last time are not gone over again.
    ErrorBound prove(const SimplifiedSurface& surface);

private:
    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    double limitMm_;
    std::unique_ptr<SurfaceLookup> lookup_;  ///< of the last time
    std::vector<BrickBound> results_;        ///< of each brick
};

}  // namespace adaptiso::detail
