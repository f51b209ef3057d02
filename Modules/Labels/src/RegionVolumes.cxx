#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "Placement.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint32_t kNoRegion = ~std::uint32_t{0};

/// Wanted labels as numbers from 0 on, ascending, without 0, the outside.
class RegionNumbers {
public:
    RegionNumbers(const LabelGrid& grid, const DualComplex& complex) {
        Label last = 0;
        for (const DualComplex::Polygon& polygon : complex.polygons) {
            for (const Label label : polygon.labels) {
                if (label == 0 || label == last || !grid.isWanted(label)) continue;
                labels_.push_back(last = label);
            }
            if (labels_.size() > kMany) sort();
        }
        sort();
    }

    std::size_t count() const { return labels_.size(); }
    /// kNoRegion for the outside and for what is not wanted.
    std::uint32_t of(Label label) const {
        const auto at = std::lower_bound(labels_.begin(), labels_.end(), label);
        return at != labels_.end() && *at == label
                   ? static_cast<std::uint32_t>(at - labels_.begin())
                   : kNoRegion;
    }

private:
    static constexpr std::size_t kMany = 1 << 20;

    void sort() {
        std::sort(labels_.begin(), labels_.end());
        labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
    }
    std::vector<Label> labels_;
};

/// A polygon's vertices of groups, and the area vector and volume (towards the origin) of the fan
/// that they make.
struct Facet {
    std::array<VertexId, 12> vertices;
    int count = 0;
    Vec3 area;
    double volume = 0;

    Facet(const DualComplex& complex, const DualComplex::Polygon& polygon,
          const std::vector<Vec3>& points) {
        for (const VertexId v : complex.cornersOf(polygon)) {
            if (v < complex.groupCount) vertices[count++] = v;
        }
        for (int n = 1; n + 1 < count; ++n) {
            const Vec3 &a = points[vertices[0]], &b = points[vertices[n]],
                       &c = points[vertices[n + 1]];
            area += 0.5 * areaVector2(a, b, c);
            volume += dot(a, cross(b, c)) / 6;
        }
    }
};

struct Region {
    double voxels = 0, volume = 0, area = 0;

    /// Volume that it lacks, beyond what is left as it is: a hundredth, and more of what is thicker
    /// than some voxels. Edges that smoothing rounds off are not made up for by large walls.
    double lack() const {
        constexpr double kFree = 0.01, kThick = 1.5;  // thickness: a third of a ball's radius
        // nothing is thicker than a ball: what smoothing closed up has next to no area left
        const double ofBall = portable::cubeRoot(voxels / (36 * std::numbers::pi));
        const double thickness = std::min(voxels / std::max(area, 1e-9), ofBall) / kThick;
        const double free = kFree * voxels * (1 + portable::power(thickness, 4));
        const double all = voxels - volume;
        return all - std::clamp(all, -free, free);
    }
};

using Sides = std::array<std::uint32_t, 2>;  ///< regions that a polygon's normal leaves and enters

/// Adds up what some polygons have.
void measure(const DualComplex& complex, const std::vector<std::uint32_t>& polygons,
             const std::vector<Sides>& sides, const std::vector<Vec3>& points,
             std::vector<Region>& regions) {
    for (Region& region : regions) region.volume = region.area = 0;
    for (std::size_t n = 0; n < polygons.size(); ++n) {
        const Facet facet(complex, complex.polygons[polygons[n]], points);
        const double area = norm(facet.area);
        for (int side = 0; side < 2; ++side) {
            if (sides[n][side] == kNoRegion) continue;
            regions[sides[n][side]].volume += side == 0 ? facet.volume : -facet.volume;
            regions[sides[n][side]].area += area;
        }
    }
}

std::vector<Region> countVoxels(const LabelGrid& grid, const RegionNumbers& numbers) {
    std::vector<Region> regions(numbers.count());
    Label last = 0;
    std::uint32_t number = kNoRegion;
    for (const Label label : grid.labels) {
        if (label == 0) continue;
        if (label != last) number = numbers.of(last = label);
        if (number != kNoRegion) ++regions[number].voxels;
    }
    return regions;
}

}  // namespace

void restoreVolumes(const LabelGrid& grid, const DualComplex& complex,
                    const std::vector<Room>& rooms, std::vector<Vec3>& points) {
    constexpr int kRounds = 12;
    constexpr double kLargestStep = 0.2;  // voxels
    const RegionNumbers numbers(grid, complex);
    std::vector<Region> regions = countVoxels(grid, numbers);
    std::vector<std::uint32_t> polygons(complex.polygons.size());
    std::vector<Sides> sides(complex.polygons.size());
    for (std::uint32_t p = 0; p < polygons.size(); ++p) {
        const auto [from, into] = complex.polygons[p].labels;
        polygons[p] = p;
        sides[p] = {numbers.of(from), numbers.of(into)};
    }
    measure(complex, polygons, sides, points, regions);
    // from here on only the walls of those that lack something
    std::vector<std::uint8_t> isLacking(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) isLacking[r] = regions[r].lack() != 0 ? 1 : 0;
    std::size_t kept = 0;
    for (std::size_t n = 0; n < polygons.size(); ++n) {
        Sides own = sides[n];
        for (std::uint32_t& side : own) {
            if (side != kNoRegion && isLacking[side] == 0) side = kNoRegion;
        }
        if (own == Sides{kNoRegion, kNoRegion}) continue;
        polygons[kept] = polygons[n];
        sides[kept++] = own;
    }
    if (kept == 0) return;
    polygons.resize(kept);
    sides.resize(kept);
    std::vector<Vec3> way(points.size());
    std::vector<double> weight(points.size());
    for (int round = 0; round < kRounds; ++round) {
        std::fill(way.begin(), way.end(), Vec3{});
        std::fill(weight.begin(), weight.end(), 0);
        for (std::size_t n = 0; n < polygons.size(); ++n) {
            const Facet facet(complex, complex.polygons[polygons[n]], points);
            const auto outward = [&](std::uint32_t side) {
                if (side == kNoRegion || !(regions[side].area > 0)) return 0.0;
                return std::clamp(regions[side].lack() / regions[side].area, -kLargestStep,
                                  kLargestStep);
            };
            // who lacks most has the say: a small region's facets are small beside its neighbours'
            const double push = outward(sides[n][0]) - outward(sides[n][1]);
            const double say = std::abs(push);
            const Vec3 step = say * push * facet.area;
            const double area = say * norm(facet.area);
            for (int c = 0; c < facet.count; ++c) {
                way[facet.vertices[c]] += step;
                weight[facet.vertices[c]] += area;
            }
        }
        for (std::size_t v = 0; v < rooms.size(); ++v) {
            if (weight[v] > 0) points[v] = heldIn(rooms[v], points[v] + (1 / weight[v]) * way[v]);
        }
        measure(complex, polygons, sides, points, regions);
    }
}

}  // namespace adaptiso::detail
