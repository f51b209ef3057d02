#pragma once

#include <algorithm>
#include <cmath>

#include "adaptiso/SurfaceProof/PieceBound.h"

namespace adaptiso::detail {

/// A triangle, ready to tell of many points whether they lie within a distance of it.
class NearTriangle {
public:
    NearTriangle(const Corners& t, double squaredDistance)
        : t_(t),
          squared_(squaredDistance),
          e_(t[1] - t[0]),
          f_(t[2] - t[0]),
          area2_(cross(e_, f_)),
          ee_(squaredNorm(e_)),
          ef_(dot(e_, f_)),
          ff_(squaredNorm(f_)),
          area_(squaredNorm(area2_)),
          isFlat_(!(area_ > kFlat * ee_ * ff_)) {}

    bool has(const Vec3& p) const {
        if (isFlat_) return squaredDistanceToTriangle(p, t_) <= squared_;
        const Vec3 q = p - t_[0];
        const double height = dot(area2_, q);  // times the doubled area
        if (height * height > squared_ * area_) return false;
        const double d = dot(q, e_), g = dot(q, f_);
        const double u = ff_ * d - ef_ * g,
                     v = ee_ * g - ef_ * d;  // of the corners 1 and 2, x area
        // beyond a side the nearest point lies on such a side
        const bool isBeyondF = u < 0, isBeyondE = v<0, isBeyondThird = u + v> area_;
        if (!isBeyondF && !isBeyondE && !isBeyondThird) return true;
        const double qq = squaredNorm(q);
        return (isBeyondF && isNear(qq, g, ff_)) || (isBeyondE && isNear(qq, d, ee_)) ||
               (isBeyondThird && isNear(qq - 2 * d + ee_, g - d - ef_ + ee_, ff_ - 2 * ef_ + ee_));
    }

private:
    /// Below this part of the product of its sides the squared double area is lost in rounding.
    static constexpr double kFlat = 1e-8;

    /// \param qq  squared distance of a point from a side's begin \param along  product with the
    /// side \param length  of the side, squared
    bool isNear(double qq, double along, double length) const {
        if (along <= 0) return qq <= squared_;
        if (along >= length) return qq - 2 * along + length <= squared_;
        return qq * length - along * along <= squared_ * length;
    }

    const Corners& t_;
    double squared_;
    Vec3 e_, f_, area2_;
    double ee_, ef_, ff_, area_;  ///< area: squared and doubled twice
    bool isFlat_;
};

/// A side of a triangle that a point lies beyond, by the corner that it begins at; -1 for a point
/// over the triangle.
inline int sideTowards(const Vec3& p, const Corners& t) {
    const Vec3 e = t[1] - t[0], f = t[2] - t[0], q = p - t[0];
    const double ee = squaredNorm(e), ef = dot(e, f), ff = squaredNorm(f), d = dot(q, e),
                 g = dot(q, f);
    const double u = ff * d - ef * g, v = ee * g - ef * d;  // of the corners 1 and 2, x area
    if (u < 0) return 2;
    if (v < 0) return 0;
    return u + v > ee * ff - ef * ef ? 1 : -1;
}

}  // namespace adaptiso::detail
