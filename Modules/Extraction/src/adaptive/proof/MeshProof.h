#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/SurfaceProof/SurfaceWalk.h"
#include "adaptive/full/MeshParts.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/proof/DistanceProof.h"

namespace adaptiso::detail {

/// The proof for a mesh: goes over the triangles of both surfaces, each by walks on the other.
class MeshProof final : public DistanceProof {
public:
    /// Keeps references to all it is given.
    /// \param limitMm  what is farther than that is noted
    MeshProof(const MeshParts& parts, const MetricFrame& frame, double limitMm);

    ErrorBound prove(const SimplifiedSurface& surface) override;
    ErrorBound proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes) override;

private:
    /// What is to be proved: all where a list is empty.
    struct Scope {
        std::vector<std::uint8_t> isKnown;      ///< of each triangle of the simplified surface
        std::vector<std::uint8_t> isFineKnown;  ///< of each one of the full surface
    };
    Scope scopeOf(const SimplifiedSurface& surface, const SurfaceChanges& changes);
    void remember(std::size_t triangles, std::vector<PlaceBeyond> beyond);
    void markFine(const std::vector<Corners>& changed, Scope& scope);
    ErrorBound prove(const SimplifiedSurface& surface, const Scope& scope);
    double largestSampleDistance(const SimplifiedSurface& surface) const;

    const MeshParts& parts_;
    const MetricFrame& frame_;
    double limitMm_;
    WalkableSurface<std::uint32_t> fine_;  ///< empty until it is needed
    TreeOnDemand fineTree_;
    double enoughMm_ = 0;  ///< no bound need be tighter
    double provedMm_ = 0;  ///< so far, of what lies within the limit
    // of the last surface; empty where none was proved
    std::vector<std::uint8_t> isWithin_;  ///< the limit, each triangle
    std::vector<PlaceBeyond> beyond_;
};

}  // namespace adaptiso::detail
