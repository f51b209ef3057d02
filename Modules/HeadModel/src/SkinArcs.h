#pragma once

#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::headmodel {

/// Where rays meet a closed surface.
struct RayHits {
    std::vector<double> mm;  ///< along the ray, ascending
};
/// \param direction  of unit length
RayHits rayHits(const TriangleMesh& mesh, const Vec3& origin, const Vec3& direction);

/// A line on a surface, by its corners.
class Arc {
public:
    explicit Arc(std::vector<Vec3> corners);
    /// The point at a share of its length, 0 to 1.
    Vec3 at(double share) const;
    /// The share at which the corner nearest to a point lies.
    double shareNear(const Vec3& point) const;
    double lengthMm() const { return lengths_.back(); }

private:
    std::vector<Vec3> corners_;
    std::vector<double> lengths_;  ///< up to each corner
};

/// The part of a plane's cut through a closed surface that leads from (the place nearest to) `from`
/// past `by` to `to`; the plane is that of the three. None where they are on one line or the cut is
/// empty.
std::optional<Arc> arcThrough(const TriangleMesh& mesh, const Vec3& from, const Vec3& by,
                              const Vec3& to);

}  // namespace adaptiso::headmodel
