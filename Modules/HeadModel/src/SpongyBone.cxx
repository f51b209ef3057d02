#include "adaptiso/HeadModel/SpongyBone.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "ImageSteps.h"
#include "Voxelized.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/AabbTree.h"

namespace adaptiso {

using namespace headmodel;

std::optional<FractionField> spongySolid(const SegmentedHead& head, const TriangleMesh& innerSkull,
                                         const TriangleMesh& outerSkull, double gapMm,
                                         double roomVoxels, double stepMm) {
    constexpr double kSigmaVoxels = 0.7, kMarginMm = 6;
    const FloatImage labels{head.grid, {head.isSpongy.begin(), head.isSpongy.end()}};
    Index3 first, last;
    if (!boundingIndices(labels.values, head.grid.size, kFractionIsovalue, first, last)) {
        return std::nullopt;
    }
    FractionField solid;
    solid.grid = workingGrid(head.grid, first, last, stepMm, kMarginMm);
    const double step = headmodel::stepMm(solid.grid), leastMm = gapMm + roomVoxels * step;
    solid.part = smoothed(resampled(labels, solid.grid, 0), solid.grid, kSigmaVoxels * step);
    const Mask inner = voxelized(innerSkull, solid.grid), outer = voxelized(outerSkull, solid.grid);
    const AabbTree innerTree(innerSkull), outerTree(outerSkull);
    const std::int64_t width = solid.grid.size[0], height = solid.grid.size[1];
    forVoxels(solid.part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            float& part = solid.part[static_cast<std::size_t>(n)];
            if (part == 0) continue;
            if (inner[static_cast<std::size_t>(n)] != 0 ||
                outer[static_cast<std::size_t>(n)] == 0) {
                part = 0;
                continue;
            }
            const std::int64_t i = n % width, j = n / width % height, k = n / (width * height);
            const Vec3 place = solid.grid.toPhysical(
                {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
            const double farMm =
                std::sqrt(std::min(innerTree.closestPoint(place).squaredDistanceMm2,
                                   outerTree.closestPoint(place).squaredDistanceMm2));
            // two voxels wide, so that it changes evenly where the surface passes
            part = std::min(part, partAtDepth(farMm - leastMm, 2 * step));
        }
    });
    if (std::ranges::none_of(solid.part, [](float part) { return part >= kFractionIsovalue; })) {
        return std::nullopt;
    }
    return solid;
}

}  // namespace adaptiso
