#pragma once

#include <vector>

#include "Bricks.h"
#include "MetricFrame.h"
#include "SimplifiedSurface.h"

namespace adaptiso::detail {

/// Bounds of the distance between the full-resolution surface and the simplified one, mm: no point
/// of the one is farther from the other.
struct ErrorBound {
    double fromFineMm = 0;  ///< points of the full-resolution surface
    double toFineMm = 0;    ///< points of the simplified surface
    /// Pieces of either surface that lie beyond the limit: one point of each, metric frame.
    std::vector<Vec3> beyondLimit;

    double largest() const { return fromFineMm > toFineMm ? fromFineMm : toFineMm; }
};

/// Proves bounds by going over both surfaces brick by brick, the full-resolution one made anew.
///
/// A piece of a triangle lies within d of a surface if its corners lie within d of one and the same
/// triangle of it: the distance to a convex set is a convex function. Pieces that do not are
/// quartered. Nothing of what the simplification believed is trusted, except for where to look
/// first.
/// \param limitMm  what is farther than that is noted in beyondLimit
ErrorBound boundError(const SimplifiedSurface& surface, const LatticeSampler& sampler,
                      const Bricks& bricks, const MetricFrame& frame, double limitMm);

}  // namespace adaptiso::detail
