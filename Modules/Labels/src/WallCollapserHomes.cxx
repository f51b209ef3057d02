// Quick tests of the distance: where samples of the full walls go when an edge collapses, and
// whether what is made lies near the full walls.
#include <algorithm>
#include <cmath>
#include <limits>

#include "WallCollapser.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptive/proof/NearTriangle.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Edges longer than this are looked at in three places, else in the middle alone.
constexpr double kLongVoxels = 1.5, kAside = 0.25;

double squaredDistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 e = b - a;
    const double length2 = squaredNorm(e);
    const double t = length2 > 0 ? std::clamp(dot(p - a, e) / length2, 0.0, 1.0) : 0;
    return squaredNorm(p - a - t * e);
}

}  // namespace

WallCollapser::Plane::Plane(const std::array<Vec3, 3>& corners) : corner(corners[0]) {
    const Vec3 e = corners[1] - corners[0], f = corners[2] - corners[0];
    const double ee = squaredNorm(e), ef = dot(e, f), ff = squaredNorm(f), area = ee * ff - ef * ef;
    if (!(area > 1e-8 * ee * ff)) return;
    const double by = 1 / area;
    toFirst = by * (ff * e - ef * f);
    toSecond = by * (ee * f - ef * e);
    normal = std::sqrt(by) * cross(e, f);
}

/// What replaces the star.
void WallCollapser::findParts(Id u, Id v, const Plan& plan) {
    parts_.clear();
    curveParts_.clear();
    const bool isOnCurve = plan.kind != Kind::Wall;
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]);
        auto c = mesh_.cornersOf(star_[i]);
        for (int n = 0; n < 3; ++n) {
            if (t.v[n] != u && t.v[n] != v) continue;
            c[n] = plan.point;
            if (!isOnCurve || mesh_.kind(t.v[n]) == Kind::Wall) continue;
            for (const int m : {(n + 1) % 3, (n + 2) % 3}) {
                const Id p = t.v[m];
                if (mesh_.kind(p) == Kind::Wall || mesh_.orderOf(t.v[n], p) < 3) continue;
                curveParts_.push_back({mesh_.point(p), static_cast<Id>(i),
                                       static_cast<std::uint8_t>(m == (n + 1) % 3 ? n : m)});
            }
        }
        parts_.push_back({c, t.wall, Plane(c)});
    }
}

/// The part of a wall that a sample belongs to: one that it lies over and within the limit, or the
/// nearest one. \return  the squared distance
double WallCollapser::homeOnWall(const Vec3& p, Id wall, std::size_t first, double limit2,
                                 NewHome& home) {
    for (std::size_t step = 0; step < kept_; ++step) {
        const std::size_t n = first + step < kept_ ? first + step : first + step - kept_;
        const Part& part = parts_[n];
        if (part.wall != wall || part.plane.isFlat() || !part.plane.isUnder(p)) continue;
        const double height = part.plane.heightOf(p);
        if (height * height > limit2) continue;
        home.star = static_cast<Id>(n);
        return height * height;
    }
    double best2 = kInfinity;
    for (std::size_t n = 0; n < kept_; ++n) {
        const Part& part = parts_[n];
        if (part.wall != wall) continue;
        const double height = part.plane.heightOf(p);
        if (height * height >= std::min(best2, limit2 * (1 + 1e-9))) continue;
        const auto& c = part.corners;
        const double d2 = squaredNorm(p - closestPointOnTriangle(p, c[0], c[1], c[2]));
        if (d2 < best2) {
            best2 = d2;
            home.star = static_cast<Id>(n);
        }
    }
    return best2;
}

/// The same of a sample on a curve, of a triangle of the star.
double WallCollapser::homeOnCurve(const Vec3& p, Id u, Id v, const Plan& plan, std::size_t i,
                                  NewHome& home) {
    const auto& t = mesh_.triangle(star_[i]);
    const Id a = t.v[home.slot], b = t.v[(home.slot + 1) % 3];
    if (a != u && a != v && b != u && b != v && i < kept_) {
        home.star = static_cast<Id>(i);
        return 0;
    }
    double best2 = kInfinity;
    for (const CurvePart& part : curveParts_) {
        const double d2 = squaredDistanceToSegment(p, plan.point, part.end);
        if (d2 >= best2) continue;
        best2 = d2;
        home.star = part.star;
        home.slot = part.slot;
    }
    return best2;
}

/// Assigns the samples of the star to what replaces it.
/// \return false when one lies too far from that
bool WallCollapser::findHomes(Id u, Id v, const Plan& plan, double limitMm) {
    findParts(u, v, plan);
    newHomes_.clear();
    double nearest2 = kInfinity;
    nearestSample_ = kNone;
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const Id wall = mesh_.triangle(star_[i]).wall;
        for (Id s = firstSample_[star_[i]]; s != kNone; s = samples_[s].next) {
            const Sample& sample = samples_[s];
            const Vec3& p = sample.point;
            NewHome home{s, kNone, sample.slot, p};
            const double allowed = limitMm * sample.tightness, limit2 = allowed * allowed;
            const double squared = sample.slot == kOnWall
                                       ? homeOnWall(p, wall, i < kept_ ? i : 0, limit2, home)
                                       : homeOnCurve(p, u, v, plan, i, home);
            if (!(squared <= limit2)) return false;
            if (const double d2 = squaredNorm(p - plan.point); d2 < nearest2) {
                nearest2 = d2;
                nearestSample_ = s;
            }
            newHomes_.push_back(home);
        }
    }
    if (nearestSample_ == kNone) nearestSample_ = origin_[u];
    return true;
}

/// The full walls come near the point, as far as those round the nearest sample show.
bool WallCollapser::isNearFull(const Vec3& point, double limitMm) {
    limitMm *= samples_[nearestSample_].tightness;
    const double limit2 = limitMm * limitMm;
    const auto isLevel = [&](const Plane& plane) {
        const double height = plane.heightOf(point);
        return height * height <= limit2;
    };
    const std::span<const Id> around = fullAround(nearestSample_);
    for (const Id t : around) {
        const Plane& plane = fullPlanes_[t];
        if (!plane.isFlat() && isLevel(plane) && plane.isUnder(point)) return true;
    }
    return std::any_of(around.begin(), around.end(), [&](Id t) {
        if (!isLevel(fullPlanes_[t])) return false;
        const auto& v = patch_.fullTriangles[t].v;
        const std::array<Vec3, 3> corners{patch_.fullPoints[v[0]], patch_.fullPoints[v[1]],
                                          patch_.fullPoints[v[2]]};
        return NearTriangle(corners, limit2).has(point);
    });
}

/// The full walls round the sample nearest to the point come near it.
bool WallCollapser::isNearSamples(const Vec3& point, double limitMm) {
    double nearest2 = kInfinity;
    for (const NewHome& home : newHomes_) {
        const double d2 = squaredNorm(home.point - point);
        if (d2 >= nearest2) continue;
        nearest2 = d2;
        nearestSample_ = home.sample;
    }
    return nearest2 == kInfinity || isNearFull(point, limitMm);
}

/// Points on the edges at the new vertex are near the full walls: a ridge may pass between
/// samples.
bool WallCollapser::spokesAreNear(const Plan& plan, double limitMm) {
    const double long2 = kLongVoxels * kLongVoxels * voxelMm_ * voxelMm_;
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]).v;
        for (const Id x : t) {
            if (mark_[x] == stamp_) continue;
            mark_[x] = stamp_;
            const Vec3 way = mesh_.point(x) - plan.point;
            if (!isNearSamples(plan.point + 0.5 * way, limitMm)) return false;
            if (squaredNorm(way) < long2) continue;
            if (!isNearSamples(plan.point + kAside * way, limitMm) ||
                !isNearSamples(plan.point + (1 - kAside) * way, limitMm)) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace adaptiso::detail
