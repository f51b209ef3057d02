#pragma once

#include <memory>
#include <vector>

#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/mesh/WholeBricks.h"
#include "adaptive/proof/BrickProof.h"
#include "adaptive/proof/DistanceProof.h"
#include "adaptive/proof/SurfaceLookup.h"

namespace adaptiso::detail {

/// The proof for a volume: goes over both surfaces brick by brick, the full-resolution one made
/// anew.
class ErrorProof final : public DistanceProof {
public:
    /// \param limitMm  what is farther than that is noted in ErrorBound::beyondLimit
    ErrorProof(const LatticeSampler& sampler, const Bricks& bricks, const MetricFrame& frame,
               double limitMm);

    ErrorBound prove(const SimplifiedSurface& surface) override;
    ErrorBound proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes) override;

private:
    ProofScope scopeOf(const SurfaceLookup& lookup, const SurfaceChanges& changes) const;
    ErrorBound prove(const SimplifiedSurface& surface, const ProofScope& scope);
    void includeFarPieces(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
                          ErrorBound& bound) const;
    void markBeyond(ProofScope& scope) const;
    void markAround(const Corners& triangle, double distanceMm, ProofScope& scope) const;
    void remember(std::vector<PlaceBeyond> beyond);

    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    double limitMm_;
    double enoughMm_ = 0;  ///< no bound need be tighter
    double provedMm_ = 0;  ///< so far, of what lies within the limit
    WholeBricks whole_;    ///< of the surface as it is
    // of the last surface; none where not all of it was proved
    std::unique_ptr<SurfaceLookup> lookup_;
    std::vector<std::uint8_t> isWithin_;  ///< the limit, each triangle
    std::vector<PlaceBeyond> beyond_;
    SampleNumbers numbers_;
};

}  // namespace adaptiso::detail
