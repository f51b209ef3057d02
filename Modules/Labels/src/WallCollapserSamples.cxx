// Quick tests of the distance: where samples of the full walls go when an edge collapses, and
// whether what is made lies near the full walls.
#include <algorithm>
#include <cmath>

#include "WallCollapser.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/SurfaceProof/NearTriangle.h"

namespace adaptiso::detail {
namespace {

/// Edges longer than this are looked at in three places, else in the middle alone.
constexpr double kLongVoxels = 1.5, kAside = 0.25;

/// Triangles of a fan from here on share a bit: hardly any has as many.
constexpr std::size_t kMostBits = 31;

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

/// The triangles that replace the star.
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
double WallCollapser::assignOnWall(const Vec3& p, Id wall, std::size_t first, double limit2,
                                   NewAssignment& assigned) {
    for (std::size_t step = 0; step < kept_; ++step) {
        const std::size_t n = first + step < kept_ ? first + step : first + step - kept_;
        const Part& part = parts_[n];
        if (part.wall != wall || part.plane.isFlat() || !part.plane.isUnder(p)) continue;
        const double height = part.plane.heightOf(p);
        if (height * height > limit2) continue;
        assigned.star = static_cast<Id>(n);
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
            assigned.star = static_cast<Id>(n);
        }
    }
    return best2;
}

/// The same for a sample on a curve, of a triangle of the star.
double WallCollapser::assignOnCurve(const Vec3& p, Id u, Id v, const Plan& plan, std::size_t i,
                                    NewAssignment& assigned) {
    const auto& t = mesh_.triangle(star_[i]);
    const Id a = t.v[assigned.slot], b = t.v[(assigned.slot + 1) % 3];
    if (a != u && a != v && b != u && b != v && i < kept_) {
        assigned.star = static_cast<Id>(i);
        return 0;
    }
    double best2 = kInfinity;
    for (const CurvePart& part : curveParts_) {
        const double d2 = squaredDistanceToSegment(p, plan.point, part.end);
        if (d2 >= best2) continue;
        best2 = d2;
        assigned.star = part.star;
        assigned.slot = part.slot;
    }
    return best2;
}

/// Assigns the samples of the star to what replaces it.
/// \return false when one lies too far from that
bool WallCollapser::assignSamples(Id u, Id v, const Plan& plan, double limitMm) {
    findParts(u, v, plan);
    newAssignments_.clear();
    samplePoints_.clear();
    double nearest2 = kInfinity;
    nearestSample_ = kNone;
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const Id wall = mesh_.triangle(star_[i]).wall;
        for (Id s = firstSample_[star_[i]]; s != kNone; s = samples_[s].next) {
            const Sample& sample = samples_[s];
            const Vec3& p = sample.point;
            NewAssignment assigned{s, kNone, sample.slot};
            const double allowed = limitMm * sample.tightness, limit2 = allowed * allowed;
            const double squared = sample.slot == kOnWall
                                       ? assignOnWall(p, wall, i < kept_ ? i : 0, limit2, assigned)
                                       : assignOnCurve(p, u, v, plan, i, assigned);
            if (!(squared <= limit2)) return false;
            if (const double d2 = squaredNorm(p - plan.point); d2 < nearest2) {
                nearest2 = d2;
                nearestSample_ = s;
            }
            newAssignments_.push_back(assigned);
            samplePoints_.add(p);
        }
    }
    if (nearestSample_ == kNone) nearestSample_ = origin_[u];
    return true;
}

std::size_t WallCollapser::SamplePoints::nearestTo(const Vec3& p) {
    squared_.resize(x_.size());
    for (std::size_t n = 0; n < x_.size(); ++n) {
        const double dx = x_[n] - p.x, dy = y_[n] - p.y, dz = z_[n] - p.z;
        squared_[n] = dx * dx + dy * dy + dz * dz;
    }
    return static_cast<std::size_t>(std::min_element(squared_.begin(), squared_.end()) -
                                    squared_.begin());
}

/// The full walls come near the point, as far as those round a sample show.
bool WallCollapser::isNearFull(const Vec3& point, Id sample, double limitMm) const {
    const Sample& nearest = samples_[sample];
    limitMm *= nearest.tightness;
    const Vec3 to = point - nearest.point;
    const std::array way{static_cast<float>(to.x), static_cast<float>(to.y),
                         static_cast<float>(to.z)};
    const auto most = static_cast<float>(limitMm);
    const std::span<const FanPlane> fan{fans_.data() + fullBegin_[sample],
                                        fullAround(sample).size()};
    unsigned level = 0;  // a bit for each whose plane passes near
    for (std::size_t n = 0; n < fan.size(); ++n) {
        if (std::abs(fan[n].heightOf(way)) > most) continue;
        // one without a plane lies over nothing
        if (fan[n].isUnder(way) && fan[n].normal != std::array<float, 3>{}) return true;
        level |= 1U << std::min<std::size_t>(n, kMostBits);
    }
    const double limit2 = limitMm * limitMm;
    for (std::size_t n = 0; n < fan.size(); ++n) {
        if ((level >> std::min<std::size_t>(n, kMostBits) & 1U) == 0) continue;
        const auto& v = patch_.fullTriangles[fullAround(sample)[n]].v;
        const std::array<Vec3, 3> corners{samples_[v[0]].point, samples_[v[1]].point,
                                          samples_[v[2]].point};
        if (NearTriangle(corners, limit2).has(point)) return true;
    }
    return false;
}

/// Points on the edges at the new vertex are near the full walls, as those round the nearest
/// samples show: a ridge may pass between samples.
bool WallCollapser::spokesAreNear(const Plan& plan, double limitMm) {
    if (samplePoints_.isEmpty()) return true;
    const double long2 = kLongVoxels * kLongVoxels * voxelMm_ * voxelMm_;
    onSpokes_.clear();
    const auto ask = [&](const Vec3& point) {
        const Id nearest = newAssignments_[samplePoints_.nearestTo(point)].sample;
        // what lies there is asked for soon
        __builtin_prefetch(fans_.data() + fullBegin_[nearest]);
        __builtin_prefetch(fans_.data() + fullBegin_[nearest] + 2);
        onSpokes_.push_back({point, nearest});
    };
    for (std::size_t i = 0; i < kept_; ++i) {
        for (const Id x : mesh_.triangle(star_[i]).v) {
            if (mark_[x] == stamp_) continue;
            mark_[x] = stamp_;
            const Vec3 way = mesh_.point(x) - plan.point;
            ask(plan.point + 0.5 * way);
            if (squaredNorm(way) < long2) continue;
            ask(plan.point + kAside * way);
            ask(plan.point + (1 - kAside) * way);
        }
    }
    return std::all_of(onSpokes_.begin(), onSpokes_.end(), [&](const OnSpoke& at) {
        return isNearFull(at.point, at.nearest, limitMm);
    });
}

}  // namespace adaptiso::detail
