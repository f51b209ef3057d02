#include "adaptive/collapse/ChangedStar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adaptiso/Core/PortableMath.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

/// The largest squared cosine of a triangle's corners from its squared sides and 4 area^2: that of
/// its sharpest corner, between the two longer sides.
double sharpestSquaredCosine(double a, double b, double c, double area2Squared) {
    const double shortest = std::min({a, b, c});
    const double others = a * b * c / shortest;  // product of the two longer ones
    return 1 - area2Squared / others;
}

/// The sharpest corner is wide enough, or wider than the sharpest before.
/// \param sharpest  squared cosine of the changed star's
bool anglesMayStay(const Patch& patch, const Star& star, const StarLimits& limits,
                   double sharpest) {
    const auto point = [&](std::uint32_t v) { return patch.points[v]; };
    const double cosine = portable::cos(limits.leastAngleDeg * std::numbers::pi / 180);
    if (sharpest <= cosine * cosine) return true;
    double sharpestBefore = 0;
    const auto addBefore = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
        sharpestBefore =
            std::max(sharpestBefore,
                     sharpestSquaredCosine(squaredNorm(q - p), squaredNorm(r - q),
                                           squaredNorm(p - r), squaredNorm(areaVector2(p, q, r))));
    };
    for (int i = 0; i < star.count; ++i) {
        addBefore(point(star.apex[i]), point(star.ring[i]), point(star.ring[i + 1]));
    }
    for (int i = 0; i < star.removedCount; ++i) {
        const auto& t = patch.triangles[star.removed[i]];
        addBefore(point(t[0]), point(t[1]), point(t[2]));
    }
    return sharpest < sharpestBefore;
}

}  // namespace

Refusal shapeStar(const Patch& patch, const StarLimits& limits, ChangedStar& changed) {
    const Star& star = changed.star;
    const auto point = [&](std::uint32_t v) { return patch.points[v]; };
    std::array<Vec3, Star::kMost> before;
    Vec3 mean;
    for (int i = 0; i < star.count; ++i) {
        const Vec3 r = point(star.ring[i]), s = point(star.ring[i + 1]);
        before[i] = areaVector2(point(star.apex[i]), r, s);
        mean += before[i];
        changed.wedge[i].e1 = r - changed.vertex;
        changed.wedge[i].e2 = s - changed.vertex;
    }
    for (int i = 0; i < star.removedCount; ++i) {
        const auto& t = patch.triangles[star.removed[i]];
        mean += areaVector2(point(t[0]), point(t[1]), point(t[2]));
    }
    const Vec3 normal = changed.normal = normalized(mean);
    const Vec3 across = std::abs(normal.x) < std::abs(normal.y) ? cross(normal, {1, 0, 0})
                                                                : cross(normal, {0, 1, 0});
    changed.isGraph = !star.isOpen;
    int turns = 0;        // how often the spokes pass the direction from which `across` grows
    double sharpest = 0;  // squared cosine
    for (int i = 0; i < star.count; ++i) {
        ChangedStar::Wedge& w = changed.wedge[i];
        const Vec3 after = w.area2 = cross(w.e1, w.e2);
        const double squared = squaredNorm(after), area2 = w.length = std::sqrt(squared);
        w.a11 = squaredNorm(w.e1);
        w.a12 = dot(w.e1, w.e2);
        w.a22 = squaredNorm(w.e2);
        w.inverse = 1 / squared;
        const double third = w.a11 + w.a22 - 2 * w.a12;
        if (!(area2 > kFlatTriangle * std::max({w.a11, w.a22, third}))) return Refusal::Flat;
        const double upright = dot(after, normal);
        if (upright < kStarCosine * area2 &&
            dot(after, before[i]) < kOwnCosine * area2 * norm(before[i])) {
            return Refusal::Turned;
        }
        if (!(upright > 0) || !(dot(before[i], normal) > 0)) changed.isGraph = false;
        if (dot(w.e1, across) < 0 && dot(w.e2, across) >= 0) ++turns;
        if (limits.leastAngleDeg > 0) {
            sharpest = std::max(sharpest, sharpestSquaredCosine(w.a11, w.a22, third, squared));
        }
    }
    if (turns != 1) changed.isGraph = false;
    const bool maySharpen =
        limits.leastAngleDeg == 0 || anglesMayStay(patch, star, limits, sharpest);
    return maySharpen ? Refusal::None : Refusal::SharpCorner;
}

}  // namespace adaptiso::detail
