#include <gtest/gtest.h>

#include <utility>

#include "BoxSurface.h"
#include "FillLoops.h"
#include "RandomVolumes.h"
#include "SurfaceLoops.h"

namespace adaptiso::detail {
namespace {

/// The method's steps with vertex and half-edge numbers of type Id.
template <class Id>
TriangleMesh meshWith(const testing::HardVolume& hard, Division division,
                      VertexPlacement placement) {
    const VolumeView& volume = hard.volume;
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {4, Border::Closed});
    const BlockGrid grid = index.grid();
    const auto sampler = LatticeSampler::make(volume, hard.isovalue, grid.border);
    ActiveBlocks active(grid, index.blocksAt(hard.isovalue).blocks);
    BoxSurface<4, Id> surface = makeBoxSurface<4, Id>(*sampler, std::move(active), division);
    std::int64_t edgesSplit = 0;
    return fillLoops(makeSurfaceLoops<4, Id>(std::move(surface)), *sampler, volume.geometry(),
                     grid.offset, placement, edgesSplit);
}

}  // namespace

// volumes large enough to need 64-bit numbers do not fit a test; their code is run on small ones
TEST(WideNumbers, GiveTheSameMeshWith64BitNumbers) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const testing::HardVolume hard = testing::hardVolume(seed, 14);
        for (const auto& [division, placement] :
             {std::pair{Division::Simple, VertexPlacement::Crossing},
              std::pair{Division::Unit, VertexPlacement::Midpoint}}) {
            const TriangleMesh wide = meshWith<std::uint64_t>(hard, division, placement);
            testing::expectSound(wide);
            ASSERT_EQ(wide, meshWith<std::uint32_t>(hard, division, placement)) << "seed " << seed;
        }
    }
}

}  // namespace adaptiso::detail
