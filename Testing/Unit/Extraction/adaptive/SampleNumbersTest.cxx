#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <utility>

#include "RandomVolumes.h"
#include "Surfaces.h"
#include "adaptive/bricks/SampleNumbers.h"

namespace adaptiso::testing {
namespace {

using detail::FineSurface;
using detail::FineVertex;
using detail::SampleNumbers;

/// The vertex's lattice edge; of the middles of cells, where they lie.
using Key = std::pair<std::uint64_t, std::array<double, 3>>;

Key keyOf(const FineVertex& vertex) {
    if (vertex.edge.axis() < 3) return {vertex.edge.word, {}};
    return {vertex.edge.word, {vertex.index.x, vertex.index.y, vertex.index.z}};
}

Index3 placeOf(std::uint32_t block, const BlockGrid& grid) {
    return {block % grid.blocks[0], block / grid.blocks[0] % grid.blocks[1],
            block / (grid.blocks[0] * grid.blocks[1])};
}

bool areBeside(std::uint32_t a, std::uint32_t b, const BlockGrid& grid) {
    const Index3 p = placeOf(a, grid), q = placeOf(b, grid);
    return std::abs(p[0] - q[0]) <= 1 && std::abs(p[1] - q[1]) <= 1 && std::abs(p[2] - q[2]) <= 1;
}

/// Calls f(vertex) for the corners of the triangles that came with a block.
template <class F>
void forEachCorner(const FineSurface& fine, const detail::Brick& brick, std::uint32_t block,
                   const BlockGrid& grid, const F& f) {
    const Index3 place = placeOf(block, grid);
    forEachCellTriangle(fine, brick, [&](const Index3& cell, std::size_t t) {
        const int side = grid.blockSize;
        const bool isIn = Index3{cell[0] / side, cell[1] / side, cell[2] / side} == place;
        if (t >= fine.ownTriangles || !isIn) return;
        for (const std::uint32_t v : fine.triangles[t]) f(v);
    });
}

}  // namespace

// Random volumes with middles of cells among them, blocks of 2, 4 and 8 cells, both borders.
TEST(SampleNumbers, OfAPartAreThoseOfTheWhole) {
    std::size_t compared = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const HardVolume hard = hardVolume(seed, seed % 4 == 0 ? 40 : 12);
        const Border border = seed % 2 == 0 ? Border::Closed : Border::Open;
        const auto index = SpanSpaceIndex::build(hard.volume.view(), {2 << seed % 3, border});
        const BlockGrid& grid = index.grid();
        const auto sampler =
            detail::LatticeSampler::make(hard.volume.view(), hard.isovalue, border);
        const detail::Bricks bricks(grid, index.blocksAt(hard.isovalue).blocks);
        detail::BrickMesher mesher(*sampler, grid);
        SampleNumbers numbers(bricks);
        for (std::int64_t b = 0; b < bricks.count(); ++b) {
            FineSurface whole, part;
            std::vector<std::uint32_t> ofWhole, ofPart;
            mesher.mesh(bricks[b], whole);
            numbers.ofWhole(b, whole, ofWhole);
            std::map<Key, std::uint32_t> expected;
            std::uint32_t within = 0;
            for (std::size_t v = 0; v < whole.vertices.size(); ++v) {
                EXPECT_EQ(ofWhole[v], whole.vertices[v].isOnWall ? SampleNumbers::kNone : within++);
                expected[keyOf(whole.vertices[v])] = ofWhole[v];
            }
            for (std::size_t n = seed % 7; n < bricks[b].blocks.size(); n += 7) {
                const std::uint32_t block = bricks[b].blocks[n];
                mesher.meshWithHalo(
                    bricks, b, [&](std::uint32_t other) { return areBeside(block, other, grid); },
                    part);
                numbers.ofPart(b, part, ofPart);
                forEachCorner(part, bricks[b], block, grid, [&](std::uint32_t v) {
                    ASSERT_EQ(ofPart[v], expected.at(keyOf(part.vertices[v]))) << seed;
                    ++compared;
                });
            }
        }
    }
    EXPECT_GT(compared, 10000U);
}

}  // namespace adaptiso::testing
