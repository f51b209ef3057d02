#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// By a power of two, which changes no digit.
inline void scale(TriangleMesh& mesh, int exponent) {
    for (Vec3& p : mesh.points) {
        p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
    }
}

/// The power of two that brings a mesh of a very large or very small unit to about 1; else 0.
/// Quadrics are fourth powers of lengths in single precision: of a mesh of 2^-24 small ones lose
/// digits.
inline int exponentTowardsOne(const TriangleMesh& mesh) {
    constexpr int kFarFromOne = 12;
    if (mesh.points.empty()) return 0;
    const BoundingBox box = boundingBox(mesh);
    const Vec3 extent = box.size();
    const double largest = std::max({extent.x, extent.y, extent.z});
    if (!std::isfinite(largest) || !(largest > 0)) return 0;
    const int exponent = std::ilogb(largest);
    return std::abs(exponent) > kFarFromOne ? -exponent : 0;
}

}  // namespace adaptiso::detail
