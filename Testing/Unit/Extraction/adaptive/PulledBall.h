#pragma once

#include <algorithm>
#include <limits>

#include "Surfaces.h"
#include "adaptive/proof/DistanceProof.h"

namespace adaptiso::testing {

inline detail::DistanceProof proofOf(const detail::SimplifiedSurface& surface, const Scene& scene,
                                     double limitMm) {
    return {{surface.fine.points, surface.fine.triangles}, scene.frame, limitMm};
}

/// The ball's surface in eight bricks, as it is and with changes.
struct ProvedBall {
    Scene scene = ballScene();
    detail::SimplifiedSurface full = scene.fullSurface();

    detail::DistanceProof proof(double limitMm = std::numeric_limits<double>::max()) const {
        return proofOf(full, scene, limitMm);
    }
    /// All vertices taken outward.
    detail::SimplifiedSurface outward(double mm) const {
        detail::SimplifiedSurface moved = full;
        for (Vec3& p : moved.points) p = p + mm * normalized(p - kBallMiddle);
        return moved;
    }
    /// The vertex nearest to a place.
    std::uint32_t vertexAt(const Vec3& place) const {
        const auto at = std::min_element(
            full.points.begin(), full.points.end(),
            [&](const Vec3& p, const Vec3& q) { return norm(p - place) < norm(q - place); });
        return static_cast<std::uint32_t>(at - full.points.begin());
    }
};

/// Pulls a vertex away from the ball's middle.
inline detail::SurfaceChanges pull(detail::SimplifiedSurface& surface, std::uint32_t vertex,
                                   double mm) {
    const Vec3& p = surface.points[vertex];
    return moveVertex(surface, vertex, p + mm * normalized(p - kBallMiddle));
}

}  // namespace adaptiso::testing
