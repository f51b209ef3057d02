#include <gtest/gtest.h>

#include <utility>

#include "RandomVolumes.h"
#include "boxes/AscSurface.h"
#include "boxes/BoxSurface.h"
#include "filling/FillLoops.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {
namespace {

template <class Id>
SurfaceLoops<Id> loopsOf(Method method, const LatticeSampler& sampler, ActiveBlocks active) {
    if (method == Method::SkeletonClimbing) {
        ExtractionStatistics statistics;
        return makeAscLoops<4, Id>(sampler, active, statistics);
    }
    const Division division =
        method == Method::DiscretizedMarchingCubes ? Division::Unit : Division::Simple;
    return makeSurfaceLoops<4, Id>(makeBoxSurface<4, Id>(sampler, std::move(active), division));
}

/// A method's steps with vertex and half-edge numbers of type Id.
template <class Id>
TriangleMesh meshWith(const testing::HardVolume& hard, Method method, VertexPlacement placement) {
    const VolumeView& volume = hard.volume;
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {4, Border::Closed});
    const BlockGrid grid = index.grid();
    const auto sampler = LatticeSampler::make(volume, hard.isovalue, grid.border);
    ActiveBlocks active(grid, index.blocksAt(hard.isovalue).blocks);
    std::int64_t edgesSplit = 0;
    return fillLoops(loopsOf<Id>(method, *sampler, std::move(active)), *sampler, volume.geometry(),
                     grid.offset, placement, edgesSplit);
}

}  // namespace

// volumes large enough to need 64-bit numbers do not fit a test; their code is run on small ones
TEST(WideNumbers, GiveTheSameMeshWith64BitNumbers) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const testing::HardVolume hard = testing::hardVolume(seed, 14);
        for (const auto& [method, placement] :
             {std::pair{Method::Boxes, VertexPlacement::Crossing},
              std::pair{Method::DiscretizedMarchingCubes, VertexPlacement::Midpoint},
              std::pair{Method::SkeletonClimbing, VertexPlacement::Crossing}}) {
            const TriangleMesh wide = meshWith<std::uint64_t>(hard, method, placement);
            testing::expectSound(wide);
            ASSERT_EQ(wide, meshWith<std::uint32_t>(hard, method, placement))
                << toString(method) << ", seed " << seed;
        }
    }
}

}  // namespace adaptiso::detail
