#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

using Corners = std::array<Vec3, 3>;

struct CornerBox {
    Vec3 low, high;

    bool overlaps(const CornerBox& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
               low.z <= o.high.z && o.low.z <= high.z;
    }
    void add(const Vec3& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void widen(double by) {
        low = low - Vec3{by, by, by};
        high = high + Vec3{by, by, by};
    }
};
inline CornerBox boxOf(const Corners& c) {
    CornerBox box{c[0], c[0]};
    box.add(c[1]);
    box.add(c[2]);
    return box;
}

/// A little below a number, in single precision; and a little above.
inline float floatBelow(double x) {
    const auto f = static_cast<float>(x);
    return f - (2 * std::numeric_limits<float>::epsilon() * std::abs(f) +
                std::numeric_limits<float>::min());
}
inline float floatAbove(double x) {
    const auto f = static_cast<float>(x);
    return f + (2 * std::numeric_limits<float>::epsilon() * std::abs(f) +
                std::numeric_limits<float>::min());
}

/// 0.8 degrees: sharper folds are refused while simplifying.
inline constexpr double kSquaredSineOfFold = 1.95e-4;

// Conservative proofs that two triangles of a mesh do not cross: `true` is certain, `false` means
// only that none of the planes tried lies between them. Both triangles keep `gap` mm of room
// beyond what is proved, so that rounding can't undo it.

/// Triangles that share no vertex: a plane lies between them (separating axis theorem: the two
/// normals, the nine products of edges and the six of normals and edges).
bool areApart(const Corners& a, const Corners& b, double gap);

/// Triangles that share the vertex a[0] = b[0] and no other: a plane through it lies between them.
bool touchAtVertexOnly(const Corners& a, const Corners& b, double gap);

/// Triangles that share the edge a[0] a[1] = b[1] b[0]: they are not folded onto each other, that
/// is, more than an angle lies between them.
/// \param squaredSine  of the angle
bool touchAtEdgeOnly(const Corners& a, const Corners& b, double squaredSine = kSquaredSineOfFold);

}  // namespace adaptiso::detail
