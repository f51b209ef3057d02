#include "SkinArcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace adaptiso::headmodel {
namespace {

using EdgeKey = std::pair<VertexId, VertexId>;

EdgeKey keyOf(VertexId a, VertexId b) {
    return {std::min(a, b), std::max(a, b)};
}

/// Where a plane crosses the edges of a mesh, and which crossings a triangle joins.
struct Crossings {
    std::map<EdgeKey, std::size_t> number;
    std::vector<Vec3> points;
    std::vector<std::array<std::size_t, 2>> neighbours;  ///< of each: two, of a closed surface
    std::vector<int> degree;

    std::size_t at(const EdgeKey& key, const Vec3& point) {
        const auto [found, isNew] = number.try_emplace(key, points.size());
        if (isNew) {
            points.push_back(point);
            neighbours.push_back({});
            degree.push_back(0);
        }
        return found->second;
    }
    void join(std::size_t a, std::size_t b) {
        for (const auto& [n, other] : {std::pair{a, b}, std::pair{b, a}}) {
            if (degree[n] < 2) neighbours[n][static_cast<std::size_t>(degree[n]++)] = other;
        }
    }
};

Crossings crossingsOf(const TriangleMesh& mesh, const Vec3& point, const Vec3& normal) {
    Crossings crossings;
    const auto height = [&](VertexId v) { return dot(mesh.points[v] - point, normal); };
    for (const Triangle& t : mesh.triangles) {
        std::array<std::size_t, 2> ends{};
        std::size_t count = 0;
        for (int side = 0; side < 3; ++side) {
            const EdgeKey key = keyOf(t[side], t[(side + 1) % 3]);
            const double a = height(key.first), b = height(key.second);
            if ((a >= 0) == (b >= 0)) continue;
            const Vec3 crossing = mesh.points[key.first] +
                                  a / (a - b) * (mesh.points[key.second] - mesh.points[key.first]);
            if (count < 2) ends[count++] = crossings.at(key, crossing);
        }
        if (count == 2) crossings.join(ends[0], ends[1]);
    }
    return crossings;
}

/// Each closed line of the cut, corner by corner.
std::vector<std::vector<Vec3>> loopsOf(const Crossings& crossings) {
    std::vector<std::vector<Vec3>> loops;
    std::vector<bool> isDone(crossings.points.size());
    for (std::size_t start = 0; start < isDone.size(); ++start) {
        if (isDone[start]) continue;
        loops.emplace_back();
        std::size_t last = start, now = start;
        while (!isDone[now]) {
            isDone[now] = true;
            loops.back().push_back(crossings.points[now]);
            if (crossings.degree[now] < 2) break;
            const auto& next = crossings.neighbours[now];
            const std::size_t other = next[0] == last && now != start ? next[1] : next[0];
            last = now;
            now = other;
        }
    }
    return loops;
}

/// The corner of a line nearest to a point, and its squared distance.
std::pair<std::size_t, double> nearestCorner(const std::vector<Vec3>& line, const Vec3& p) {
    std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
    for (std::size_t n = 0; n < line.size(); ++n) {
        const double distance = squaredNorm(line[n] - p);
        if (distance < best.second) best = {n, distance};
    }
    return best;
}

/// With a corner where the line comes nearest to `p`.
std::size_t insertNearest(std::vector<Vec3>& line, const Vec3& p) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    Vec3 place;
    for (std::size_t n = 0; n < line.size(); ++n) {
        const Vec3 &a = line[n], &b = line[(n + 1) % line.size()];
        const double length = squaredNorm(b - a);
        const double share = length > 0 ? std::clamp(dot(p - a, b - a) / length, 0.0, 1.0) : 0;
        const Vec3 q = a + share * (b - a);
        if (squaredNorm(q - p) < least) {
            least = squaredNorm(q - p);
            best = n;
            place = q;
        }
    }
    line.insert(line.begin() + static_cast<std::ptrdiff_t>(best) + 1, place);
    return best + 1;
}

}  // namespace

RayHits rayHits(const TriangleMesh& mesh, const Vec3& origin, const Vec3& direction) {
    RayHits hits;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.points[t[0]], ab = mesh.points[t[1]] - a, ac = mesh.points[t[2]] - a;
        const Vec3 across = cross(direction, ac);
        const double volume = dot(ab, across);
        if (volume == 0) continue;
        const Vec3 from = origin - a;
        const double u = dot(from, across) / volume;
        const Vec3 turned = cross(from, ab);
        const double v = dot(direction, turned) / volume;
        const double mm = dot(ac, turned) / volume;
        if (u >= 0 && v >= 0 && u + v <= 1 && mm > 0) hits.mm.push_back(mm);
    }
    std::sort(hits.mm.begin(), hits.mm.end());
    return hits;
}

Arc::Arc(std::vector<Vec3> corners) : corners_(std::move(corners)), lengths_{0} {
    for (std::size_t n = 1; n < corners_.size(); ++n) {
        lengths_.push_back(lengths_.back() + norm(corners_[n] - corners_[n - 1]));
    }
}

Vec3 Arc::at(double share) const {
    const double mm = share * lengthMm();
    for (std::size_t n = 1; n < corners_.size(); ++n) {
        if (lengths_[n] < mm) continue;
        const double step = lengths_[n] - lengths_[n - 1];
        const double part = step > 0 ? (mm - lengths_[n - 1]) / step : 0;
        return corners_[n - 1] + part * (corners_[n] - corners_[n - 1]);
    }
    return corners_.back();
}

double Arc::shareNear(const Vec3& point) const {
    return lengths_[nearestCorner(corners_, point).first] / lengthMm();
}

std::optional<Arc> arcThrough(const TriangleMesh& mesh, const Vec3& from, const Vec3& by,
                              const Vec3& to) {
    const Vec3 normal = cross(by - from, to - from);
    if (!(norm(normal) > 1e-6 * norm(by - from) * norm(to - from))) return std::nullopt;
    std::vector<std::vector<Vec3>> loops = loopsOf(crossingsOf(mesh, from, normalized(normal)));
    std::erase_if(loops, [](const auto& loop) { return loop.size() < 3; });
    if (loops.empty()) return std::nullopt;
    auto& loop = *std::min_element(loops.begin(), loops.end(), [&](const auto& a, const auto& b) {
        return nearestCorner(a, by).second < nearestCorner(b, by).second;
    });
    insertNearest(loop, from);
    insertNearest(loop, to);
    insertNearest(loop, by);
    // begin where it starts
    const auto start = nearestCorner(loop, from).first;
    std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(start), loop.end());
    std::size_t end = nearestCorner(loop, to).first;
    if (nearestCorner(loop, by).first > end) {  // the other way round
        std::reverse(loop.begin() + 1, loop.end());
        end = nearestCorner(loop, to).first;
    }
    if (end == 0) return std::nullopt;
    return Arc({loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(end) + 1});
}

}  // namespace adaptiso::headmodel
