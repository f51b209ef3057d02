#pragma once

#include <algorithm>
#include <array>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// The weighted sum of squared distances to planes, as a function of the point [Garland1997]:
/// x' A x + 2 b' x + c with A symmetric.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
    Vec3 b;
    double c = 0;

    /// Squared distance to the plane of a triangle, times the triangle's area.
    /// \param area2  twice its area vector \param corner  a point of the plane
    static Quadric ofTriangle(const Vec3& area2, const Vec3& corner) {
        const double length = norm(area2);
        if (!(length > 0)) return {};
        const double scale = 0.5 / length;
        const double d = -dot(area2, corner);
        const Vec3 s = scale * area2;
        return {s.x * area2.x, s.x * area2.y, s.x * area2.z, s.y * area2.y,
                s.y * area2.z, s.z * area2.z, d * s,         scale * d * d};
    }

    Quadric& operator+=(const Quadric& q) {
        xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
        b += q.b;
        c += q.c;
        return *this;
    }

    /// Sum of the weights: the area of the triangles that are in it, mm2.
    double weight() const { return xx + yy + zz; }

    Vec3 timesA(const Vec3& v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                xz * v.x + yz * v.y + zz * v.z};
    }

    double at(const Vec3& p) const { return dot(p, timesA(p) + 2.0 * b) + c; }
};

inline Quadric operator+(Quadric a, const Quadric& b) {
    return a += b;
}

/// A quadric seen from a point near its planes, which loses little in single precision.
struct StoredQuadric {
    std::array<float, 10> number{};

    static StoredQuadric of(const Quadric& q, const Vec3& origin) {
        const Vec3 b = q.timesA(origin) + q.b;
        const std::array exact{q.xx, q.xy, q.xz, q.yy, q.yz, q.zz, b.x, b.y, b.z, q.at(origin)};
        StoredQuadric stored;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            stored.number[i] = static_cast<float>(exact[i]);
        }
        return stored;
    }
    /// \param q  relative to the same point
    StoredQuadric& operator+=(const StoredQuadric& q) {
        for (std::size_t i = 0; i < number.size(); ++i) number[i] += q.number[i];
        return *this;
    }
    Quadric about(const Vec3& origin) const {
        Quadric q;
        q.xx = number[0], q.xy = number[1], q.xz = number[2];
        q.yy = number[3], q.yz = number[4], q.zz = number[5];
        const Vec3 b{number[6], number[7], number[8]}, moved = q.timesA(origin);
        q.b = b - moved;
        q.c = number[9] - dot(origin, b + q.b);
        return q;
    }
};

struct QuadricMinimum {
    Vec3 point;
    double error = 0;
};

/// The point of least error near `guess`. Where the planes leave a direction open or nearly so, the
/// point stays close to the guess along it: A is made stiffer by `stiffness` times its trace.
inline QuadricMinimum minimize(const Quadric& q, const Vec3& guess, double stiffness = 1e-3) {
    const double stiff = stiffness * (q.xx + q.yy + q.zz) + 1e-300;
    const Vec3 slope = q.timesA(guess) + q.b;
    // (A + stiff I) step = -slope, by the adjugate
    const double xx = q.xx + stiff, yy = q.yy + stiff, zz = q.zz + stiff;
    const double cxx = yy * zz - q.yz * q.yz, cxy = q.xz * q.yz - q.xy * zz,
                 cxz = q.xy * q.yz - q.xz * yy, cyy = xx * zz - q.xz * q.xz,
                 cyz = q.xy * q.xz - xx * q.yz, czz = xx * yy - q.xy * q.xy;
    const double determinant = xx * cxx + q.xy * cxy + q.xz * cxz;
    const double s = determinant > 0 ? -1 / determinant : 0;
    const Vec3 step{s * (cxx * slope.x + cxy * slope.y + cxz * slope.z),
                    s * (cxy * slope.x + cyy * slope.y + cyz * slope.z),
                    s * (cxz * slope.x + cyz * slope.y + czz * slope.z)};
    const double error =
        dot(guess, slope + q.b) + q.c + 2 * dot(step, slope) + dot(step, q.timesA(step));
    return {guess + step, std::max(error, 0.0)};
}

}  // namespace adaptiso::detail
