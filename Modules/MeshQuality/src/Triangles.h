#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

// Shared by the exact tests of this module.

/// `p` seen along an axis.
inline Point2 dropAxis(const Vec3& p, int axis) {
    return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

/// An axis along which the triangle is seen with area; -1 when its corners lie on a line.
inline int axisWithArea(const Corners& t) {
    for (int axis = 0; axis < 3; ++axis) {
        if (orient2d(dropAxis(t[0], axis), dropAxis(t[1], axis), dropAxis(t[2], axis)) != 0) {
            return axis;
        }
    }
    return -1;
}

inline bool haveOneSign(int a, int b, int c) {
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

inline bool areFinite(const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(),
                       [](const Vec3& p) { return std::isfinite(p.x + p.y + p.z); });
}

/// Where `p` lies of the line from -> to: 1 left, -1 right, never 0. Ties are broken by moving p by
/// (e^2, e), e infinitely small; 0 only where from and to are one point.
int perturbedSide(const Point2& p, const Point2& from, const Point2& to);

/// A ray along an axis.
struct Ray {
    int axis;
    int sign;  ///< 1 towards larger coordinates, -1 towards smaller ones
};

struct Hit {
    bool isOn = false;     ///< the ray's origin is on the triangle
    bool crosses = false;  ///< the ray passes through
};

/// Meeting of a ray from `p` and a triangle, decided exactly. Ties are broken by moving the ray
/// sideways by (e^2, e), e infinitely small, so that of the triangles round an edge or a corner it
/// crosses those that a ray beside it does. \pre p and the corners are finite
Hit hitOf(const Vec3& p, const Ray& ray, const Corners& t);

/// Box of all that the ray passes.
BoundingBox boxOf(const Vec3& p, const Ray& ray);

/// \throws InvalidInput naming `function` when a triangle names a point that is not there
inline void requireIndices(const TriangleMesh& mesh, std::string_view function) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        for (const VertexId v : mesh.triangles[n]) {
            if (v >= 0 && v < count) continue;
            throw InvalidInput(std::string(function) + ": triangle " + std::to_string(n) +
                               " names vertex " + std::to_string(v) + " of a mesh with " +
                               std::to_string(count) + " points");
        }
    }
}

}  // namespace adaptiso
