#include "adaptiso/MeshQuality/Certificate.h"

#include <algorithm>

namespace adaptiso {
namespace {

struct Interval {
    double low, high;
};

Interval project(const Corners& t, const Vec3& axis) {
    const double p = dot(t[0], axis), q = dot(t[1], axis), r = dot(t[2], axis);
    return {std::min({p, q, r}), std::max({p, q, r})};
}

/// The projections on `axis` are `gap` or more apart.
bool separates(const Vec3& axis, const Corners& a, const Corners& b, double gap) {
    const double length = norm(axis);
    if (!(length > 0)) return false;
    const Interval u = project(a, axis), v = project(b, axis);
    return std::max(v.low - u.high, u.low - v.high) > gap * length;
}

std::array<Vec3, 3> edges(const Corners& t) {
    return {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
}

/// The plane through the common vertex at right angles to `axis` has one triangle on either side.
/// Where both have an edge in the plane, the edges must leave the vertex in different directions.
/// Arguments are the other corners, seen from the vertex.
bool dividesAtVertex(const Vec3& axis, const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b,
                     double gap) {
    constexpr double kSquaredSine = 1e-20;  // of the least angle between such edges
    const double room = gap * norm(axis);
    if (!(room > 0)) return false;
    const std::array<double, 2> heightA{dot(a[0], axis), dot(a[1], axis)},
        heightB{dot(b[0], axis), dot(b[1], axis)};
    // rounding may put a corner that spans the axis just beyond the plane
    const double slack = 1e-3 * room;
    for (const double sign : {1.0, -1.0}) {
        const double a0 = sign * heightA[0], a1 = sign * heightA[1], b0 = -sign * heightB[0],
                     b1 = -sign * heightB[1];
        if (std::min({a0, a1, b0, b1}) < -slack) continue;
        if (std::min(a0, a1) > room || std::min(b0, b1) > room) return true;
        if (!(std::max(a0, a1) > room && std::max(b0, b1) > room)) continue;
        const Vec3 &p = a0 < a1 ? a[0] : a[1], &q = b0 < b1 ? b[0] : b[1];
        if (dot(p, q) < 0 ||
            squaredNorm(cross(p, q)) > kSquaredSine * squaredNorm(p) * squaredNorm(q)) {
            return true;
        }
    }
    return false;
}

}  // namespace

bool areApart(const Corners& a, const Corners& b, double gap) {
    const auto ea = edges(a), eb = edges(b);
    const Vec3 na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
    if (separates(na, a, b, gap) || separates(nb, a, b, gap)) return true;
    for (const Vec3& p : ea) {
        for (const Vec3& q : eb) {
            if (separates(cross(p, q), a, b, gap)) return true;
        }
    }
    for (int i = 0; i < 3; ++i) {
        if (separates(cross(na, ea[i]), a, b, gap) || separates(cross(nb, eb[i]), a, b, gap)) {
            return true;
        }
    }
    return false;
}

bool touchAtVertexOnly(const Corners& a, const Corners& b, double gap) {
    const std::array<Vec3, 2> u{a[1] - a[0], a[2] - a[0]}, v{b[1] - b[0], b[2] - b[0]};
    const Vec3 na = cross(u[0], u[1]), nb = cross(v[0], v[1]);
    if (dividesAtVertex(na, u, v, gap) || dividesAtVertex(nb, u, v, gap)) return true;
    for (const Vec3& p : u) {
        for (const Vec3& q : v) {
            if (dividesAtVertex(cross(p, q), u, v, gap)) return true;
        }
    }
    for (int i = 0; i < 2; ++i) {
        if (dividesAtVertex(cross(na, u[i]), u, v, gap) ||
            dividesAtVertex(cross(nb, v[i]), u, v, gap)) {
            return true;
        }
    }
    return false;
}

bool touchAtEdgeOnly(const Corners& a, const Corners& b, double squaredSine) {
    const Vec3 edge = a[1] - a[0];
    const double length2 = squaredNorm(edge);
    if (!(length2 > 0)) return false;
    const auto sideways = [&](const Vec3& p) {
        const Vec3 d = p - a[0];
        return d - (dot(d, edge) / length2) * edge;
    };
    const Vec3 u = sideways(a[2]), v = sideways(b[2]);
    const double product = dot(u, v), squares = squaredNorm(u) * squaredNorm(v);
    if (!(squares > 0)) return false;
    // sine by the cross product: exact enough for the smallest angles too
    return product <= 0 || squaredNorm(cross(u, v)) > squaredSine * squares + 1e-24 * squares;
}

}  // namespace adaptiso
