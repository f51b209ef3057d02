#pragma once

#include <vector>

#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/proof/BrickProof.h"
#include "adaptive/proof/SurfaceLookup.h"

namespace adaptiso::detail {

struct ErrorBound {
    /// No point of the full-resolution surface is farther from the simplified one, and none of the
    /// latter from the former.
    double largestMm = 0;
    std::vector<PlaceBeyond> beyondLimit;
};

/// Proves bounds by going over both surfaces brick by brick, the full-resolution one made anew.
/// Nothing of what the simplification believed is trusted, except for where to look first.
///
/// What was proved of one surface holds for the next as far as both are the same: a triangle of
/// both lies as near to the full-resolution surface as before, and a piece of the latter has not
/// lost what is near it where no triangle came or went within the limit.
class ErrorProof {
public:
    /// \param limitMm  what is farther than that is noted in ErrorBound::beyondLimit
    ErrorProof(const LatticeSampler& sampler, const Bricks& bricks, const MetricFrame& frame,
               double limitMm);

    /// What was proved of the last surface is not proved again.
    ErrorBound prove(const SimplifiedSurface& surface);

    /// The same of the last surface after some changes.
    ErrorBound proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes);

private:
    ProofScope scopeOf(const SurfaceLookup& lookup) const;
    ProofScope scopeOf(const SurfaceLookup& lookup, const SurfaceChanges& changes) const;
    ErrorBound prove(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
                     const ProofScope& scope);
    void includeFarPieces(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
                          ErrorBound& bound) const;
    void markBeyond(ProofScope& scope) const;
    void markAround(const Corners& triangle, double distanceMm, ProofScope& scope) const;
    void remember(const SurfaceLookup& lookup, std::vector<PlaceBeyond> beyond);

    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    double limitMm_;
    double enoughMm_ = 0;  ///< no bound need be tighter
    double provedMm_ = 0;  ///< so far, of what lies within the limit
    // of the last surface; empty where not all of it was proved
    std::vector<Corners> last_;           ///< its triangles
    std::vector<std::uint8_t> isWithin_;  ///< the limit, each triangle
    std::vector<PlaceBeyond> beyond_;
};

}  // namespace adaptiso::detail
