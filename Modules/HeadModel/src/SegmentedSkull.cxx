#include "adaptiso/HeadModel/SegmentedSkull.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr double kBeyondMm = 3, kRayStepMm = 0.1;
/// Less than this is no skull: what interpolation spreads beside it.
constexpr double kLeastMm = 0.25;
/// Part of the inner skull's height below which foramina and a base that was not segmented stay.
constexpr double kBaseHeight = 0.6;

/// The part of skull at a place, between the voxels' centres; 0 outside of the image.
double skullAt(const SegmentedHead& head, const Vec3& pointMm) {
    const Vec3 at = head.grid.toIndex(pointMm);
    const Index3& size = head.grid.size;
    Index3 low{};
    Vec3 part;
    for (int a = 0; a < 3; ++a) {
        const double floor = std::floor(at[a]);
        low[a] = static_cast<std::int64_t>(floor);
        part[a] = at[a] - floor;
    }
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
        double weight = 1;
        Index3 voxel = low;
        bool isThere = true;
        for (int a = 0; a < 3; ++a) {
            const bool isHigh = (n >> a & 1) != 0;
            weight *= isHigh ? part[a] : 1 - part[a];
            voxel[a] += isHigh ? 1 : 0;
            isThere = isThere && voxel[a] >= 0 && voxel[a] < size[a];
        }
        if (!isThere || weight == 0) continue;
        sum += weight * head.isSkull[voxel[0] + size[0] * (voxel[1] + size[1] * voxel[2])];
    }
    return sum;
}

/// The skull at a vertex of the inner skull.
struct Place {
    double areaMm2 = 0;
    double modelMm = 0;      ///< to the outer skull
    double segmentedMm = 0;  ///< of skull on the way

    bool hasSkull() const { return segmentedMm >= kLeastMm; }
};

std::vector<Place> placesOf(const TriangleMesh& inner, const TriangleMesh& outer,
                            const SegmentedHead& head) {
    std::vector<Place> places(inner.points.size());
    for (const Triangle& t : inner.triangles) {
        const double area2 =
            norm(areaVector2(inner.points[t[0]], inner.points[t[1]], inner.points[t[2]]));
        for (const VertexId v : t) places[v].areaMm2 += area2 / 6;
    }
    const AabbTree tree(outer);
    parallelForPieces(std::ssize(places), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            const Vec3 start = inner.points[v];
            const Vec3 way = tree.closestPoint(start).pointMm - start;
            places[v].modelMm = norm(way);
            if (!(places[v].modelMm > 0)) continue;
            const Vec3 direction = 1 / places[v].modelMm * way;
            const auto last =
                static_cast<std::int64_t>((places[v].modelMm + kBeyondMm) / kRayStepMm);
            for (auto n = static_cast<std::int64_t>(-kBeyondMm / kRayStepMm); n <= last; ++n) {
                const Vec3 at = start + kRayStepMm * static_cast<double>(n) * direction;
                places[v].segmentedMm += kRayStepMm * skullAt(head, at);
            }
        }
    });
    return places;
}

/// The mean thickness of each place that has skull and of its neighbours that do: single ways meet
/// a part of a voxel more or less.
void average(const TriangleMesh& inner, std::vector<Place>& places) {
    std::vector<double> sum(places.size()), count(places.size());
    const auto add = [&](VertexId to, VertexId from) {
        if (!places[to].hasSkull() || !places[from].hasSkull()) return;
        sum[to] += places[from].segmentedMm;
        count[to] += 1;
    };
    for (VertexId v = 0; v < std::ssize(places); ++v) add(v, v);
    for (const Triangle& t : inner.triangles) {  // each edge is in two of them, once each way
        for (int c = 0; c < 3; ++c) add(t[c], t[(c + 1) % 3]);
    }
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (count[v] > 0) places[v].segmentedMm = sum[v] / count[v];
    }
}

/// The value that `share` of the area lies below. \param values  with their areas; not empty
double quantile(std::vector<std::pair<double, double>> values, double share) {
    std::sort(values.begin(), values.end());
    double all = 0, below = 0;
    for (const auto& [value, area] : values) all += area;
    for (const auto& [value, area] : values) {
        below += area;
        if (below >= share * all) return value;
    }
    return values.back().first;
}

/// The connected parts without skull, but for one at the lowest vertex that is an open base.
void findHoles(const TriangleMesh& inner, const std::vector<Place>& places,
               SkullComparison& comparison) {
    DisjointSets sets(std::ssize(places));
    for (const Triangle& t : inner.triangles) {
        for (int c = 0; c < 3; ++c) {
            const VertexId a = t[c], b = t[(c + 1) % 3];
            if (!places[a].hasSkull() && !places[b].hasSkull()) sets.join(a, b);
        }
    }
    const std::vector<VertexId> root = std::move(sets).names();
    const auto isLower = [](const Vec3& l, const Vec3& r) { return l.z < r.z; };
    const auto [low, high] = std::minmax_element(inner.points.begin(), inner.points.end(), isLower);
    const auto lowest = low - inner.points.begin();
    bool hasOpenBase = !places[lowest].hasSkull();
    for (std::size_t v = 0; v < places.size() && hasOpenBase; ++v) {
        hasOpenBase = root[v] != root[lowest] ||
                      inner.points[v].z <= low->z + kBaseHeight * (high->z - low->z);
    }
    std::vector<double> areaMm2(places.size());
    std::vector<Vec3> middle(places.size());
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (places[v].hasSkull() || (hasOpenBase && root[v] == root[lowest])) continue;
        areaMm2[root[v]] += places[v].areaMm2;
        middle[root[v]] += places[v].areaMm2 * inner.points[v];
    }
    for (std::size_t v = 0; v < places.size(); ++v) {
        const bool isInPart = !places[v].hasSkull() && areaMm2[root[v]] > SkullComparison::kHoleMm2;
        if (isInPart) comparison.holeVertices.push_back(static_cast<VertexId>(v));
    }
    const auto largest = std::max_element(areaMm2.begin(), areaMm2.end());
    if (largest == areaMm2.end() || !(*largest > 0)) return;
    comparison.largestHoleMm2 = *largest;
    comparison.holeMm = 1 / *largest * middle[largest - areaMm2.begin()];
}

}  // namespace

SkullComparison compareSkull(const TriangleMesh& innerSkull, const TriangleMesh& outerSkull,
                             const SegmentedHead& head) {
    std::vector<Place> places = placesOf(innerSkull, outerSkull, head);
    average(innerSkull, places);
    const Vec3 spacing = head.grid.spacingMm();
    SkullComparison comparison;
    comparison.thickerMm = std::max(0.5, 0.5 * std::max({spacing.x, spacing.y, spacing.z}));
    std::vector<std::pair<double, double>> segmented, model;
    for (std::size_t v = 0; v < places.size(); ++v) {
        const Place& place = places[v];
        comparison.areaMm2 += place.areaMm2;
        if (!place.hasSkull()) {
            comparison.absentMm2 += place.areaMm2;
            continue;
        }
        segmented.emplace_back(place.segmentedMm, place.areaMm2);
        model.emplace_back(place.modelMm, place.areaMm2);
        const double thicker = place.modelMm - place.segmentedMm;
        if (thicker > comparison.thickerMm) comparison.thickenedMm2 += place.areaMm2;
        if (thicker > comparison.mostThickenedMm) {
            comparison.mostThickenedMm = thicker;
            comparison.thickenedMm = innerSkull.points[v];
        }
    }
    if (!segmented.empty()) {
        comparison.thinMm = quantile(segmented, 0.05);
        comparison.medianMm = quantile(std::move(segmented), 0.5);
        comparison.modelMedianMm = quantile(std::move(model), 0.5);
    }
    findHoles(innerSkull, places, comparison);
    return comparison;
}

std::vector<bool> areInHoles(const std::vector<Vec3>& placesMm, const TriangleMesh& innerSkull,
                             const SkullComparison& comparison, const SegmentedHead& head) {
    std::vector<bool> isHoleVertex(innerSkull.points.size()), areIn(placesMm.size());
    for (const VertexId v : comparison.holeVertices) isHoleVertex[v] = true;
    const AabbTree tree(innerSkull);
    for (std::size_t n = 0; n < placesMm.size(); ++n) {
        const Triangle& t = innerSkull.triangles[tree.closestPoint(placesMm[n]).triangle];
        areIn[n] = std::any_of(t.begin(), t.end(), [&](VertexId v) { return isHoleVertex[v]; }) &&
                   skullAt(head, placesMm[n]) < kFractionIsovalue;
    }
    return areIn;
}

}  // namespace adaptiso
