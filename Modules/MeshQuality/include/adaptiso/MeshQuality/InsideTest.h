#pragma once

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

enum class Side { Outside, On, Inside };

/// Answers whether points lie inside a surface, exactly where it has an inside.
///
/// A point is inside when a ray from it crosses the surface an odd number of times (the even-odd
/// rule: which way round triangles are doesn't matter). Crossings are decided by orient2d and
/// orient3d; rays that would pass an edge or a corner are moved by an infinitely small amount
/// [Edelsbrunner1990, simulation of simplicity], so that each passes one triangle of the fan.
///
/// Where every edge lies in two triangles all rays agree, and one is cast. An open surface has no
/// inside; then rays are cast along the axes, and four of the six must say so. No ray is needed
/// beyond the surface's box.
/// Triangles with a corner that is not finite are not there.
/// Cost: O(log T + triangles on the ray) a point. Points may be asked for in parallel.
class InsideTest {
public:
    /// Keeps references to `mesh` and `tree` (of `mesh`), which must outlive the test.
    InsideTest(const TriangleMesh& mesh, const AabbTree& tree);

    /// On: on a triangle, to the bit. \pre p is finite
    /// \param tests  grows by the tests of a ray and a triangle; may be null
    Side sideOf(const Vec3& p, std::int64_t* tests = nullptr) const;

    /// Every edge lies in exactly two triangles of finite corners: one ray is enough.
    bool isClosed() const { return isClosed_; }

private:
    const TriangleMesh* mesh_;
    const AabbTree* tree_;
    BoundingBox box_;
    bool isClosed_;
};

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
