#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// Proves that triangles lie near a surface: one whose corners are all within the bound of the same
/// triangle of it is so as a whole, as the distance from a triangle is a convex function. Others
/// are halved, down to a size.
class NearnessProof {
public:
    /// Keeps a reference to `surface`.
    NearnessProof(const TriangleMesh& surface, double boundMm);

    struct Result {
        double upperMm = 0;           ///< no point of what is proved is farther
        std::vector<Corners> others;  ///< what is not proved
    };
    /// Adds to `result`. \param smallestMm  no corner of what is halved is nearer to its middle
    void prove(const Corners& piece, double smallestMm, Result& result) const;

private:
    /// The nearest triangle; -1: none within reach.
    std::int64_t nearest(const Vec3& p, double reachMm) const;

    const TriangleMesh& surface_;
    AabbTree tree_;
    double rounding_;  ///< of closestPointOnTriangle(), more than that
    double bound_;
};

}  // namespace adaptiso::detail
