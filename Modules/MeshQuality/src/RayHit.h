#pragma once

#include "ExactTriangle.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// A ray along an axis.
struct Ray {
    int axis;
    int sign;  ///< 1 towards larger coordinates, -1 towards smaller ones
};

struct Hit {
    bool isOn = false;     ///< the ray's origin is on the triangle
    bool crosses = false;  ///< the ray passes through
};

/// What a ray from `p` does to a triangle, decided exactly. Ties are broken by moving the ray
/// sideways by (e^2, e), e infinitely small, so that of the triangles round an edge or a corner it
/// crosses those that a ray beside it does. \pre p and the corners are finite
Hit hitOf(const Vec3& p, const Ray& ray, const Corners& t);

/// All that the ray passes.
BoundingBox boxOf(const Vec3& p, const Ray& ray);

}  // namespace adaptiso
