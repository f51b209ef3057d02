#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// A place where one of the two surfaces lies beyond the limit. Points in the metric frame.
struct PlaceBeyond {
    static constexpr SurfaceState::Number kNone = ~SurfaceState::Number{0};

    Vec3 onSimplified, onFine;  ///< one of them is the place, the other the nearest point
    SurfaceState::Number triangle =
        kNone;              ///< of the simplified surface; kNone where none was near
    bool isOfFine = false;  ///< the place is one of the full-resolution surface

    const Vec3& point() const { return isOfFine ? onFine : onSimplified; }
    double squaredDistance() const { return squaredNorm(onSimplified - onFine); }
};

struct ErrorBound {
    /// No point of the full-resolution surface is farther from the simplified one, and none of the
    /// latter from the former.
    double largestMm = 0;
    std::vector<PlaceBeyond> beyondLimit;
};

/// Proves how far a simplified surface and the full-resolution one are apart, both ways. Trusts
/// nothing that the simplification believed, except for where to look first.
///
/// The full surface is mapped to the simplified one triangle by triangle (SurfaceMap), which proves
/// most of both directions. The rest is cut into pieces along walks on the other surface
/// (SurfaceWalk); PieceBound bounds what a walk cannot settle, among all triangles near it.
///
/// A proof holds after changes as far as both surfaces stay the same: an unchanged triangle lies as
/// near to the full surface, and a piece of the latter has lost nothing near it where no triangle
/// came or went within the limit.
class DistanceProof {
public:
    /// Keeps references to all it is given.
    /// \param fine     the full-resolution surface: a 2-manifold, with borders or without
    /// \param limitMm  places farther than that are noted in ErrorBound::beyondLimit
    DistanceProof(const TriangleView& fine, const MetricFrame& frame, double limitMm);

    /// \pre the samples that are no middles are the full surface's vertices, in their order
    ErrorBound prove(const SimplifiedSurface& surface);

    /// The same of the last surface, which is still there, after some changes.
    ErrorBound proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes);

    /// Gives back the memory that proofs take; the next one makes it anew.
    void rest();

    /// Per triangle of the last surface: 1 if the full surface has it too, with the same corners.
    /// Some of those may have 0.
    const std::vector<std::uint8_t>& isFine() const { return isFine_; }

private:
    /// Triangles to prove: all if a list is empty.
    struct Scope {
        std::vector<std::uint8_t> isKnown;      ///< of each triangle of the simplified surface
        std::vector<std::uint8_t> isFineKnown;  ///< of each one of the full surface
    };
    Scope scopeOf(const SimplifiedSurface& surface, const SurfaceChanges& changes);
    void remember(std::size_t triangles, std::vector<PlaceBeyond> beyond);
    void markFine(const std::vector<Corners>& changed, Scope& scope);
    std::vector<SurfaceState::Number> trianglesFor(
        const Scope& scope, const TriangleView& simplified,
        const std::vector<SurfaceState::Number>& assigned) const;
    ErrorBound prove(const SimplifiedSurface& surface, const Scope& scope);

    TriangleView fineView_;
    const MetricFrame& frame_;
    double limitMm_;
    WalkableSurface<std::uint32_t> fine_;  ///< empty until it is needed
    std::optional<TreeOnDemand> fineTree_;
    double enoughMm_ = 0;  ///< no bound need be tighter
    double provedMm_ = 0;  ///< so far, of what lies within the limit
    // of the last surface
    std::vector<std::uint8_t> isWithin_;  ///< the limit, each triangle; empty: all was the full one
    std::vector<std::uint8_t> isFine_;
    std::vector<PlaceBeyond> beyond_;
};

}  // namespace adaptiso::detail
