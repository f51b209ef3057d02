#pragma once

#include <cstdint>
#include <vector>

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

/// Proves how far a simplified surface and the full-resolution one are apart, both ways. Nothing of
/// what the simplification believed is trusted, except for where to look first.
///
/// What was proved of a surface holds after changes as far as it is the same: a triangle of before
/// lies as near to the full-resolution surface, and a piece of the latter has not lost what is near
/// it where no triangle came or went within the limit.
class DistanceProof {
public:
    DistanceProof() = default;
    DistanceProof(const DistanceProof&) = default;
    DistanceProof(DistanceProof&&) = default;
    DistanceProof& operator=(const DistanceProof&) = delete;
    DistanceProof& operator=(DistanceProof&&) = delete;
    virtual ~DistanceProof() = default;

    virtual ErrorBound prove(const SimplifiedSurface& surface) = 0;

    /// The same of the last surface, which is still there, after some changes.
    virtual ErrorBound proveAgain(const SimplifiedSurface& surface,
                                  const SurfaceChanges& changes) = 0;
};

}  // namespace adaptiso::detail
