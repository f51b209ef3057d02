#include "RemeshTarget.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "SixEquations.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr int kNormalSmoothings = 4;  // takes the stairs out of the normals of a binary volume

/// Weights of a, b, c that give p. \pre p lies on the triangle, as near as rounding lets it
std::array<double, 3> barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = areaVector2(a, b, c);
    const double n2 = squaredNorm(n);
    if (!(n2 > 0)) return {1, 0, 0};
    const double u = std::clamp(dot(areaVector2(p, b, c), n) / n2, 0.0, 1.0);
    const double v = std::clamp(dot(areaVector2(a, p, c), n) / n2, 0.0, 1.0 - u);
    return {u, v, 1 - u - v};
}

/// Two unit vectors across n. \pre n has length 1
std::array<Vec3, 2> tangents(const Vec3& n) {
    const Vec3 axis = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = normalized(cross(axis, n));
    return {u, cross(n, u)};
}

}  // namespace

RemeshTarget::RemeshTarget(const TriangleMesh& surface)
    : surface_(surface),
      tree_(surface),
      around_(surface.points.size(),
              [&](const auto& give) {
                  for (std::int64_t t = 0; t < std::ssize(surface.triangles); ++t) {
                      for (const VertexId v : surface.triangles[t]) {
                          give(static_cast<std::size_t>(v), t);
                      }
                  }
              }),
      areaMm2_(surface.points.size()),
      normals_(surface.points.size()) {
    for (std::int64_t t = 0; t < std::ssize(surface.triangles); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        const Vec3 area2 = areaVector2(surface.points[a], surface.points[b], surface.points[c]);
        for (const VertexId v : surface.triangles[t]) {
            areaMm2_[v] += norm(area2) / 6;
            normals_[v] += area2;
        }
    }
    constexpr std::int64_t kGrain = 4096;
    const std::int64_t count = std::ssize(normals_);
    for (int round = 0; round < kNormalSmoothings; ++round) {
        std::vector<Vec3> smooth(normals_.size());
        parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t stop) {
            for (VertexId v = begin; v < stop; ++v) {
                Vec3 sum;
                for (const std::int64_t t : trianglesAround(v)) {
                    for (const VertexId w : surface_.triangles[t]) sum += normals_[w];
                }
                smooth[v] = sum;
            }
        });
        normals_ = std::move(smooth);
    }
    for (Vec3& n : normals_) n = normalized(n);
}

Landing RemeshTarget::project(const Vec3& p, std::int64_t hint) const {
    const ClosestPoint closest = tree_.closestPoint(p, hint);
    return landingAt(closest.pointMm, closest.triangle);
}

std::pair<Triangle, int> RemeshTarget::cornersBelow(const Vec3& p, std::int64_t triangle) const {
    constexpr double kOnSide = 1e-9;
    const Triangle& t = surface_.triangles[triangle];
    const auto w =
        barycentric(p, surface_.points[t[0]], surface_.points[t[1]], surface_.points[t[2]]);
    Triangle corners{};
    int count = 0;
    for (int n = 0; n < 3; ++n) {
        if (w[n] > kOnSide) corners[count++] = t[n];
    }
    return {corners, count};
}

Landing RemeshTarget::slide(const Vec3& p, std::int64_t from) const {
    ClosestPoint best;
    const auto look = [&](std::int64_t triangle) {
        const auto& [a, b, c] = surface_.triangles[triangle];
        const Vec3 nearest =
            closestPointOnTriangle(p, surface_.points[a], surface_.points[b], surface_.points[c]);
        const double squared = squaredNorm(p - nearest);
        if (squared < best.squaredDistanceMm2) best = {triangle, squared, nearest};
    };
    look(from);
    for (std::int64_t at = -1; at != best.triangle;) {
        at = best.triangle;
        // within the triangle there is none nearer beside it; on a side or corner those that
        // share it may have one
        const auto [corners, count] = cornersBelow(best.pointMm, at);
        if (count == 3) break;
        for (const std::int64_t triangle : trianglesAround(corners[0])) {
            if (triangle != at && (count == 1 || hasCorner(triangle, corners[1]))) look(triangle);
        }
    }
    return landingAt(best.pointMm, best.triangle);
}

Landing RemeshTarget::landingAt(const Vec3& pointMm, std::int64_t triangle) const {
    const auto& [a, b, c] = surface_.triangles[triangle];
    const auto w = barycentric(pointMm, surface_.points[a], surface_.points[b], surface_.points[c]);
    return {pointMm, triangle,
            normalized(w[0] * normals_[a] + w[1] * normals_[b] + w[2] * normals_[c]),
            w[0] * sizeAt(a) + w[1] * sizeAt(b) + w[2] * sizeAt(c)};
}

Landing RemeshTarget::atVertex(VertexId v) const {
    return {surface_.points[v], around_.of(static_cast<std::size_t>(v)).front(), normals_[v],
            sizeAt(v)};
}

std::vector<VertexId> RemeshTarget::facingWithin(const Landing& at, double radiusMm) const {
    // which flood saw a vertex last: kept by the thread, as to clear it costs more than a flood
    thread_local std::vector<std::uint32_t> seenBy;
    thread_local std::uint32_t flood = 0;
    if (seenBy.size() < surface_.points.size() || ++flood == 0) {
        seenBy.assign(std::max(seenBy.size(), surface_.points.size()), 0);
        flood = 1;
    }
    std::vector<VertexId> found;
    const auto visit = [&](VertexId w) {
        if (seenBy[w] == flood) return;
        seenBy[w] = flood;
        const bool isNear = squaredNorm(surface_.points[w] - at.pointMm) < radiusMm * radiusMm &&
                            dot(normals_[w], at.normal) > 0;
        if (isNear) found.push_back(w);
    };
    for (const VertexId v : surface_.triangles[at.triangle]) visit(v);
    for (std::size_t n = 0; n < found.size(); ++n) {
        for (const std::int64_t t : trianglesAround(found[n])) {
            for (const VertexId w : surface_.triangles[t]) visit(w);
        }
    }
    return found;
}

LocalFit RemeshTarget::fit(const Landing& at, double radiusMm) const {
    const auto [u, v] = tangents(at.normal);
    const std::vector<VertexId> found = facingWithin(at, radiusMm);
    SixEquations normalEquations{};
    double weights = 0;
    for (const VertexId w : found) {
        const Vec3 d = (1 / radiusMm) * (surface_.points[w] - at.pointMm);
        const double fade = 1 - squaredNorm(d);
        const double weight = areaMm2_[w] * fade * fade;
        const double x = dot(d, u), y = dot(d, v);
        const std::array<double, 6> basis{1, x, y, x * x, x * y, y * y};
        for (int row = 0; row < 6; ++row) {
            for (int k = 0; k < 6; ++k) normalEquations[row][k] += weight * basis[row] * basis[k];
            normalEquations[row][6] += weight * basis[row] * dot(d, at.normal);
        }
        weights += weight;
    }
    constexpr std::size_t kEnoughPoints = 12;  // twice the unknowns
    if (found.size() < kEnoughPoints || !(weights > 0)) return {};
    for (auto& row : normalEquations) {
        for (double& value : row) value /= weights;
    }
    constexpr double kLeastPivot = 1e-9;  // the unknowns are scaled to be of one size
    const auto x = solved(normalEquations, kLeastPivot);
    if (!x) return {};
    const double xx = 2 * (*x)[3], xy = (*x)[4], yy = 2 * (*x)[5];
    const double mean = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
    return {radiusMm * (*x)[0], (std::abs(mean) + spread) / radiusMm, true};
}

}  // namespace adaptiso
