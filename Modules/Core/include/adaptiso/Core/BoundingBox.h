#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// A box along the axes, in the unit and frame of the points that it was made of; its faces belong
/// to it.
struct BoundingBox {
    Vec3 minimum;
    Vec3 maximum;

    /// An empty box: holds what is added, nothing else.
    static BoundingBox empty() {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    }
    bool isEmpty() const { return minimum.x > maximum.x; }

    // no loops below: indices of Vec3 that the compiler can't see through cost three times as much

    void add(const Vec3& p) {
        minimum = {std::min(minimum.x, p.x), std::min(minimum.y, p.y), std::min(minimum.z, p.z)};
        maximum = {std::max(maximum.x, p.x), std::max(maximum.y, p.y), std::max(maximum.z, p.z)};
    }
    void add(const BoundingBox& other) {
        minimum = {std::min(minimum.x, other.minimum.x), std::min(minimum.y, other.minimum.y),
                   std::min(minimum.z, other.minimum.z)};
        maximum = {std::max(maximum.x, other.maximum.x), std::max(maximum.y, other.maximum.y),
                   std::max(maximum.z, other.maximum.z)};
    }
    /// Every face goes outwards by as much.
    void widen(double by) {
        minimum = minimum - Vec3{by, by, by};
        maximum = maximum + Vec3{by, by, by};
    }

    Vec3 size() const { return maximum - minimum; }
    Vec3 middle() const { return 0.5 * (minimum + maximum); }

    /// They share a point; touching is enough.
    bool overlaps(const BoundingBox& o) const {
        return minimum.x <= o.maximum.x && o.minimum.x <= maximum.x && minimum.y <= o.maximum.y &&
               o.minimum.y <= maximum.y && minimum.z <= o.maximum.z && o.minimum.z <= maximum.z;
    }
    bool contains(const BoundingBox& o) const {
        return minimum.x <= o.minimum.x && o.maximum.x <= maximum.x && minimum.y <= o.minimum.y &&
               o.maximum.y <= maximum.y && minimum.z <= o.minimum.z && o.maximum.z <= maximum.z;
    }
    bool contains(const Vec3& p) const { return contains(BoundingBox{p, p}); }
};

/// Squared distance from a point to a box; 0 inside.
inline double squaredDistance(const Vec3& p, const BoundingBox& box) {
    const auto beyond = [](double low, double at, double high) {
        return std::max(std::max(low - at, 0.0), at - high);
    };
    const double dx = beyond(box.minimum.x, p.x, box.maximum.x);
    const double dy = beyond(box.minimum.y, p.y, box.maximum.y);
    const double dz = beyond(box.minimum.z, p.z, box.maximum.z);
    return dx * dx + dy * dy + dz * dz;
}

/// Squared distance between two boxes; 0 when they overlap.
inline double squaredDistance(const BoundingBox& a, const BoundingBox& b) {
    double sum = 0;
    for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        const double d =
            std::max({a.minimum.*axis - b.maximum.*axis, 0.0, b.minimum.*axis - a.maximum.*axis});
        sum += d * d;
    }
    return sum;
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

}  // namespace adaptiso
