#pragma once

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// The solid angle of `mesh` seen from `p`, as a part of the whole sphere: the generalized winding
/// number [Jacobson2013]. 1 inside a closed surface with outward triangles, 0 outside of it, -1
/// inside one that is inside out; a fraction where the surface is open. Each triangle's angle is by
/// [vanOosterom1983]. NaN when a corner is.
/// \pre triangles name points that are there \throws InvalidInput otherwise
/// Cost: O(T), in parallel. The same bits, whatever the number of threads.
double solidAngleShare(const TriangleMesh& mesh, const Vec3& p);

/// MNE's criterion for a complete surface (mne.bem, _assert_complete_surface): the solid angle seen
/// from the mean of all vertices, used or not, is within 1e-5 of the whole sphere. So a surface
/// that is open, inside out, or does not hold its vertices' mean, fails.
struct SolidAngleCriterion {
    double share = 0;  ///< solidAngleShare from the mean of the vertices; NaN without any

    static constexpr double kTolerance = 1e-5;
    bool isMet() const { return share >= 1 - kTolerance && share <= 1 + kTolerance; }
};
SolidAngleCriterion solidAngleFromMean(const TriangleMesh& mesh);

}  // namespace adaptiso
