#include "SizeField.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr double kBendPerEdge = 0.5;  // radians: a circle gets 12 edges
constexpr double kGrowth = 0.2;       // neighbouring edges differ by less than a fourth

double meanEdgeMm(const TriangleMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        for (int side = 0; side < 3; ++side) {
            sum += norm(mesh.points[t[side]] - mesh.points[t[(side + 1) % 3]]);
        }
    }
    return sum / static_cast<double>(3 * mesh.triangles.size());
}

/// Vertices such that every vertex has one of them within `distanceMm` of it along the surface, and
/// no two are as near.
std::vector<VertexId> spacedVertices(const RemeshTarget& target, double distanceMm) {
    const TriangleMesh& surface = target.surface();
    std::vector<VertexId> chosen, flood;
    std::vector<VertexId> reachedFrom(surface.points.size(), -1);
    std::vector<bool> isNear(surface.points.size());
    for (VertexId v = 0; v < std::ssize(surface.points); ++v) {
        if (isNear[v] || target.trianglesAround(v).empty()) continue;
        chosen.push_back(v);
        flood = {v};
        reachedFrom[v] = v;
        for (std::size_t n = 0; n < flood.size(); ++n) {
            isNear[flood[n]] = true;
            for (const std::int64_t t : target.trianglesAround(flood[n])) {
                for (const VertexId w : surface.triangles[t]) {
                    const double squared = squaredNorm(surface.points[w] - surface.points[v]);
                    if (reachedFrom[w] == v || !(squared < distanceMm * distanceMm)) continue;
                    reachedFrom[w] = v;
                    flood.push_back(w);
                }
            }
        }
    }
    return chosen;
}

}  // namespace

std::vector<double> spreadSizes(const RemeshTarget& target, const std::vector<SizeSeed>& seeds) {
    const TriangleMesh& surface = target.surface();
    std::vector<double> sizes(surface.points.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, VertexId>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto offer = [&](VertexId v, double sizeMm) {
        if (sizeMm >= sizes[v]) return;
        sizes[v] = sizeMm;
        queue.emplace(sizeMm, v);
    };
    for (const SizeSeed& seed : seeds) offer(seed.vertex, seed.sizeMm);
    while (!queue.empty()) {
        const auto [size, v] = queue.top();
        queue.pop();
        if (size > sizes[v]) continue;
        for (const std::int64_t t : target.trianglesAround(v)) {
            for (const VertexId w : surface.triangles[t]) {
                offer(w, size + kGrowth * norm(surface.points[w] - surface.points[v]));
            }
        }
    }
    return sizes;
}

std::vector<double> adaptiveSizes(const RemeshTarget& target, const EdgeLengthRange& range,
                                  const std::vector<const TriangleMesh*>& neighbours) {
    // Two looks a shortest edge are enough; the growth bound fills in between.
    std::vector<SizeSeed> seeds;
    for (const VertexId v : spacedVertices(target, range.minimumMm / 2)) {
        seeds.push_back({v, range.maximumMm});
    }
    std::vector<AabbTree> trees;
    trees.reserve(neighbours.size());
    for (const TriangleMesh* neighbour : neighbours) trees.emplace_back(*neighbour);
    const double radiusMm = std::max(range.minimumMm, 3 * meanEdgeMm(target.surface()));
    constexpr std::int64_t kGrain = 64;
    parallelForPieces(std::ssize(seeds), kGrain, [&](std::int64_t begin, std::int64_t end) {
        // vertices follow each other along the surface: the last one's nearest is a good start
        std::vector<std::int64_t> nearest(trees.size(), -1);
        for (std::int64_t n = begin; n < end; ++n) {
            const Landing at = target.atVertex(seeds[n].vertex);
            const LocalFit fit = target.fit(at, radiusMm);
            // where nothing can be fitted the surface bends sharply
            double size = fit.isValid ? kBendPerEdge / fit.curvaturePerMm : range.minimumMm;
            for (std::size_t tree = 0; tree < trees.size(); ++tree) {
                const ClosestPoint there = trees[tree].closestPoint(at.pointMm, nearest[tree]);
                nearest[tree] = there.triangle;
                size = std::min(size, std::sqrt(there.squaredDistanceMm2));
            }
            seeds[n].sizeMm = std::clamp(size, range.minimumMm, range.maximumMm);
        }
    });
    return spreadSizes(target, seeds);
}

}  // namespace adaptiso
