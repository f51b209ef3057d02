#include "PlanarFiller.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/detail/BoxCases.h"

namespace adaptiso::detail {
namespace {

/// Smallest area of two triangles over the square of their longest edge; negative where one
/// faces the other way.
double worseShape(const std::vector<Vec3>& points, const Vec3& normal, const Triangle& s,
                  const Triangle& t) {
    double worst = 1;
    for (const auto& corners : {s, t}) {
        const Vec3 &a = points[corners[0]], &b = points[corners[1]], &c = points[corners[2]];
        const double longest =
            std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)});
        worst = std::min(worst, dot(normal, areaVector2(a, b, c)) / longest);
    }
    return worst;
}

/// A half-line from a corner, towards one beside it.
struct Ray {
    std::int64_t u, v;
    std::uint32_t corner;
    bool isOut;  ///< towards the next corner

    bool isUpper() const { return v > 0 || (v == 0 && u > 0); }
    bool operator<(const Ray& other) const {
        if (isUpper() != other.isUpper()) return isUpper();
        return u * other.v - v * other.u > 0;
    }
};

/// Where loops meet at a point, joins their edges so that each corner has one sector of the inside,
/// as PlanarTriangulator asks. Corners whose edges overlap are left as they are.
void joinSectors(std::vector<PlanarCorner>& corners, const std::vector<VertexId>& nodes) {
    std::vector<std::uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t c) { return nodes[c]; });
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        for (last = first; last < order.size() && nodes[order[last]] == nodes[order[first]];)
            ++last;
        if (last - first < 2) continue;
        std::vector<Ray> rays;
        for (std::size_t n = first; n < last; ++n) {
            const PlanarCorner& at = corners[order[n]];
            const PlanarCorner &next = corners[at.next], &previous = corners[at.previous];
            rays.push_back({next.u - at.u, next.v - at.v, at.next, true});
            rays.push_back({previous.u - at.u, previous.v - at.v, at.previous, false});
        }
        if (std::ranges::any_of(rays, [](const Ray& ray) { return ray.u == 0 && ray.v == 0; })) {
            continue;
        }
        std::ranges::sort(rays, std::less<>());
        const bool isClear = std::ranges::adjacent_find(rays, [](const Ray& a, const Ray& b) {
                                 return !(a < b) || a.isOut == b.isOut;
                             }) == rays.end();
        if (!isClear) continue;
        if (!rays.front().isOut) std::rotate(rays.begin(), rays.begin() + 1, rays.end());
        for (std::size_t n = 0; n < rays.size(); n += 2) {
            const std::uint32_t own = order[first + n / 2];
            corners[own].next = rays[n].corner;
            corners[own].previous = rays[n + 1].corner;
            corners[rays[n].corner].previous = corners[rays[n + 1].corner].next = own;
        }
    }
}

/// How many triangles fill a plane region, by Euler's formula: from the numbers of its corners,
/// its loops and its parts, which hang together by edges.
std::int64_t trianglesDue(const std::vector<PlanarCorner>& corners,
                          const std::vector<LocalTriangle>& triangles) {
    const auto count = std::ssize(corners);
    DisjointSets loops(count), parts(count);
    for (std::int64_t c = 0; c < count; ++c) {
        loops.join(c, corners[c].next);
        parts.join(c, corners[c].next);
    }
    for (const LocalTriangle& t : triangles) {
        parts.join(t[0], t[1]);
        parts.join(t[0], t[2]);
    }
    std::int64_t due = count;
    for (std::int64_t c = 0; c < count; ++c) {
        if (loops.find(c) == c) due += 2;
        if (parts.find(c) == c) due -= 4;
    }
    return due;
}

}  // namespace

void flipSlivers(const std::vector<Vec3>& points, const Vec3& normal,
                 std::vector<Triangle>& triangles) {
    constexpr int kMostRounds = 64;
    bool hasChanged = triangles.size() > 1;
    for (int round = 0; hasChanged && round < kMostRounds; ++round) {
        hasChanged = false;
        std::map<std::pair<VertexId, VertexId>, std::size_t> at;  // the triangle left of an edge
        for (std::size_t n = 0; n < triangles.size(); ++n) {
            for (int i = 0; i < 3; ++i) at[{triangles[n][i], triangles[n][(i + 1) % 3]}] = n;
        }
        std::vector<std::uint8_t> isChanged(triangles.size());
        for (std::size_t n = 0; n < triangles.size(); ++n) {
            for (int i = 0; i < 3 && isChanged[n] == 0; ++i) {
                const VertexId a = triangles[n][i], b = triangles[n][(i + 1) % 3],
                               c = triangles[n][(i + 2) % 3];
                const auto beside = at.find({b, a});
                if (beside == at.end() || isChanged[beside->second] != 0) continue;
                auto& other = triangles[beside->second];
                VertexId d = other[0];
                for (const VertexId v : other) {
                    if (v != a && v != b) d = v;
                }
                const Triangle first{a, d, c}, second{d, b, c};
                if (worseShape(points, normal, first, second) <=
                    1.01 * worseShape(points, normal, triangles[n], other) + 1e-12) {
                    continue;
                }
                triangles[n] = first;
                other = second;
                isChanged[n] = isChanged[beside->second] = 1;
                hasChanged = true;
            }
        }
    }
}

std::optional<std::vector<PlanarGroup>> PlanarFiller::fill(
    const std::vector<Vec3>& points, const Corners& plane,
    const std::vector<std::vector<VertexId>>& loops) {
    const Vec3 normal = areaVector2(plane[0], plane[1], plane[2]);
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
        if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
    }
    const BoundingBox box = boxOf(plane);
    const Vec3 size = box.size();
    constexpr double kDigits = 1 << 29;
    const double scale = kDigits / std::max({size.x, size.y, size.z});
    std::vector<PlanarCorner> corners;
    std::vector<VertexId> nodes;
    DisjointSets sets(std::ssize(loops));
    std::vector<std::int64_t> loopOf;
    for (std::size_t l = 0; l < loops.size(); ++l) {
        const auto first = static_cast<std::uint32_t>(corners.size());
        const auto count = static_cast<std::uint32_t>(loops[l].size());
        for (std::uint32_t n = 0; n < count; ++n) {
            const Vec3 p = points[loops[l][n]] - box.minimum;
            auto u = std::llround(scale * p[axisAfter(axis, 1)]),
                 v = std::llround(scale * p[axisAfter(axis, 2)]);
            if (normal[axis] < 0) std::swap(u, v);
            corners.push_back({u, v, first + (n + count - 1) % count, first + (n + 1) % count});
            nodes.push_back(loops[l][n]);
            loopOf.push_back(static_cast<std::int64_t>(l));
        }
    }
    joinSectors(corners, nodes);
    std::vector<LocalTriangle> triangles;
    try {
        triangulator_.triangulate(corners, triangles);
    } catch (const InternalError&) {
        return std::nullopt;
    }
    if (std::ssize(triangles) != trianglesDue(corners, triangles)) return std::nullopt;
    for (const LocalTriangle& local : triangles) {
        sets.join(loopOf[local[0]], loopOf[local[1]]);
        sets.join(loopOf[local[0]], loopOf[local[2]]);
    }
    std::map<std::int64_t, PlanarGroup> groups;
    for (std::size_t l = 0; l < loops.size(); ++l) {
        groups[sets.find(static_cast<std::int64_t>(l))].loops.push_back(l);
    }
    for (const LocalTriangle& local : triangles) {
        groups[sets.find(loopOf[local[0]])].triangles.push_back(
            {nodes[local[0]], nodes[local[1]], nodes[local[2]]});
    }
    std::vector<PlanarGroup> all;
    for (auto& [set, group] : groups) all.push_back(std::move(group));
    for (PlanarGroup& group : all) flipSlivers(points, normalized(normal), group.triangles);
    return all;
}

}  // namespace adaptiso::detail
