#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptive/rounds/BrickRound.h"
#include "lattice/LatticeSampler.h"

namespace adaptiso::testing {
namespace {

/// Sheets about two voxels apart, in whole numbers: many samples equal the isovalue 5.
Volume layeredVolume(std::int64_t side) {
    ImageGeometry geometry;
    geometry.size = {side, side, side};
    std::vector<std::uint8_t> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side % side),
                   z = static_cast<double>(i / (side * side));
        const double phase = 1.5 * z + std::sin(0.3 * x) + std::cos(0.2 * y);
        samples.push_back(static_cast<std::uint8_t>(std::lround(5 + 4 * std::sin(phase))));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace

// Bricks are simplified side by side, each without a look at the others: what reached into a
// neighbour could meet its triangles.
TEST(BrickRound, KeepsEachTriangleInOneBrick) {
    const Volume volume = layeredVolume(72);
    for (const Border border : {Border::Closed, Border::Open}) {
        const auto index = SpanSpaceIndex::build(volume.view(), {4, border});
        const auto sampler = detail::LatticeSampler::make(volume.view(), 5, border);
        const detail::Bricks bricks(index.grid(), index.blocksAt(5).blocks);
        ASSERT_GT(bricks.count(), 8);
        const detail::MetricFrame frame(volume.view().geometry());
        detail::PatchLimits limits;
        limits.maxCost = 10;
        limits.maxDistanceMm = 0.5;
        const detail::SimplifiedSurface surface =
            detail::simplifyBricks(*sampler, bricks, frame, {}, limits, nullptr);
        ASSERT_LT(surface.triangleCount(), surface.fineTriangles / 2);
        const auto offset = static_cast<double>(index.grid().offset);
        constexpr double kRounding = 1e-9;  // of coordinates up to 100
        for (const auto& t : surface.triangles) {
            Vec3 low = surface.points[t[0]], high = low;
            for (const std::uint64_t v : t) {
                const Vec3& p = surface.points[v];
                low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
            }
            for (int a = 0; a < 3; ++a) {
                const double wall = detail::Brick::kSide *
                                    std::ceil((low[a] + offset + kRounding) / detail::Brick::kSide);
                ASSERT_LE(high[a] + offset, wall + kRounding);
            }
        }
    }
}

}  // namespace adaptiso::testing
