#include "Necks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace adaptiso::headmodel {
namespace {

constexpr float kUnreached = std::numeric_limits<float>::infinity();

struct Step {
    std::int64_t offset;
    float mm;
};

/// To the 26 neighbours of a voxel that is not at the grid's border.
std::vector<Step> stepsOf(const ImageGeometry& grid) {
    std::vector<Step> steps;
    for (std::int64_t k = -1; k <= 1; ++k) {
        for (std::int64_t j = -1; j <= 1; ++j) {
            for (std::int64_t i = -1; i <= 1; ++i) {
                const auto squared = static_cast<double>(i * i + j * j + k * k);
                if (squared == 0) continue;
                steps.push_back({i + grid.size[0] * (j + grid.size[1] * k),
                                 static_cast<float>(std::sqrt(squared) * stepMm(grid))});
            }
        }
    }
    return steps;
}

/// The way from `core` to the voxels of `thin`, within `thin`; kUnreached elsewhere.
/// \pre neither has a voxel at the grid's border
std::vector<float> wayFrom(const Mask& core, const Mask& thin, const std::vector<Step>& steps) {
    using Place = std::pair<float, std::int64_t>;
    std::priority_queue<Place, std::vector<Place>, std::greater<>> front;
    std::vector<float> way(thin.size(), kUnreached);
    const auto reach = [&](std::int64_t voxel, float mm) {
        if (!(mm < way[voxel])) return;
        way[voxel] = mm;
        front.push({mm, voxel});
    };
    for (std::size_t n = 0; n < thin.size(); ++n) {
        if (thin[n] == 0) continue;
        for (const Step& step : steps) {
            if (core[n + step.offset] != 0) reach(static_cast<std::int64_t>(n), step.mm);
        }
    }
    while (!front.empty()) {
        const auto [mm, voxel] = front.top();
        front.pop();
        if (mm > way[voxel]) continue;
        for (const Step& step : steps) {
            if (thin[voxel + step.offset] != 0) reach(voxel + step.offset, mm + step.mm);
        }
    }
    return way;
}

Vec3 placeOf(std::int64_t voxel, const ImageGeometry& grid) {
    const std::int64_t slice = grid.size[0] * grid.size[1];
    return grid.toPhysical({static_cast<double>(voxel % grid.size[0]),
                            static_cast<double>(voxel / grid.size[0] % grid.size[1]),
                            static_cast<double>(voxel / slice)});
}

/// Components farther out than the stub that reach far enough.
std::vector<Neck> necksAlong(const std::vector<float>& way, const ImageGeometry& grid,
                             const std::vector<Step>& steps) {
    Mask left(way.size());
    for (std::size_t n = 0; n < way.size(); ++n) {
        left[n] = way[n] != kUnreached && way[n] > kNeckStubMm ? 1 : 0;
    }
    std::vector<Neck> necks;
    for (std::size_t n = 0; n < left.size(); ++n) {
        if (left[n] == 0) continue;
        Neck neck;
        neck.voxels = {static_cast<std::int64_t>(n)};
        left[n] = 0;
        std::int64_t tip = neck.voxels.front();
        for (std::size_t at = 0; at < neck.voxels.size(); ++at) {
            const std::int64_t voxel = neck.voxels[at];
            if (way[voxel] > way[tip]) tip = voxel;
            for (const Step& step : steps) {
                if (left[voxel + step.offset] == 0) continue;
                left[voxel + step.offset] = 0;
                neck.voxels.push_back(voxel + step.offset);
            }
        }
        neck.reachMm = way[tip];
        neck.mm3 = static_cast<double>(neck.voxels.size()) * std::pow(stepMm(grid), 3);
        neck.tipMm = placeOf(tip, grid);
        if (neck.reachMm > kNeckReachMm) necks.push_back(std::move(neck));
    }
    std::stable_sort(necks.begin(), necks.end(),
                     [](const Neck& a, const Neck& b) { return a.reachMm > b.reachMm; });
    return necks;
}

/// Takes voxels out of a solid, and the parts of voxels that were at their surface.
void takeOut(const Mask& cut, const ImageGeometry& grid, std::vector<float>& part) {
    const Mask solid = above(part, kFractionIsovalue);
    Mask left = solid;
    for (std::size_t n = 0; n < left.size(); ++n) {
        if (cut[n] != 0) left[n] = 0;
    }
    left = largestComponent(left, grid.size);
    const std::vector<float> depth = depthMm(left, grid, DepthBand::within(2 * stepMm(grid)));
    for (std::size_t n = 0; n < part.size(); ++n) {
        const bool isGone = solid[n] != 0 && left[n] == 0;
        if (isGone || (left[n] == 0 && depth[n] < -1.5 * stepMm(grid))) part[n] = 0;
    }
}

std::string placeText(const Vec3& lps) {
    const auto whole = [](double value) { return std::to_string(std::lround(value)); };
    return "(" + whole(-lps.x) + ", " + whole(-lps.y) + ", " + whole(lps.z) + ") mm RAS";
}

}  // namespace

std::vector<Neck> findNecks(const Mask& solid, const ImageGeometry& grid, double ballMm,
                            double closingMm) {
    const Mask whole = closed(solid, grid, closingMm);
    const Mask core = largestComponent(opened(whole, grid, ballMm), grid.size);
    if (voxelsIn(core) == 0) return {};
    Mask thin(whole.size());
    for (std::size_t n = 0; n < whole.size(); ++n) thin[n] = whole[n] & (core[n] ^ 1);
    // so that neighbours can be asked for without looking where the grid ends
    forEachBorderVoxel(grid.size, [&](std::int64_t voxel) { thin[voxel] = 0; });
    const std::vector<Step> steps = stepsOf(grid);
    std::vector<Neck> necks = necksAlong(wayFrom(core, thin, steps), grid, steps);
    for (Neck& neck : necks) {
        std::erase_if(neck.voxels, [&](std::int64_t voxel) { return solid[voxel] == 0; });
    }
    return necks;
}

void cutNecks(RawBoundaries& raw, const BoundaryOptions& options) {
    if (!(options.cutNecksMm > 0)) return;
    const ImageGeometry& grid = raw.grid;
    const Mask inner = above(raw.parts[0], kFractionIsovalue);
    const std::vector<Neck> necks = findNecks(inner, grid, options.cutNecksMm, options.closingMm);
    if (necks.empty()) return;
    Mask cut(inner.size(), 0);
    for (const Neck& neck : necks) {
        for (const std::int64_t voxel : neck.voxels) cut[voxel] = 1;
        raw.notes.push_back("inner skull: a neck of " + shortNumber(neck.reachMm) +
                            " mm, too narrow for a ball of " + shortNumber(options.cutNecksMm) +
                            " mm radius, was cut off; it ended at " + placeText(neck.tipMm));
    }
    takeOut(cut, grid, raw.parts[0]);
    if (raw.parts.size() == 1) return;

    Mask bone = above(raw.parts[1], kFractionIsovalue);
    for (std::size_t n = 0; n < bone.size(); ++n) {
        if (cut[n] != 0) bone[n] = 0;
    }
    const Mask canals = closed(bone, grid, options.cutNecksMm);
    for (std::size_t n = 0; n < cut.size(); ++n) {
        if (canals[n] != 0) cut[n] = 0;
    }
    if (voxelsIn(cut) > 0) takeOut(cut, grid, raw.parts[1]);
}

}  // namespace adaptiso::headmodel
