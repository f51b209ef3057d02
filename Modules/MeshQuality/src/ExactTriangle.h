#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "adaptiso/Core/Predicates.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

// What the exact tests of this module share.

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

}  // namespace adaptiso
