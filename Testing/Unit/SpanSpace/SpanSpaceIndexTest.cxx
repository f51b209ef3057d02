#include <gtest/gtest.h>

#include <cmath>

#include "BlocksByDefinition.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso::testing {
namespace {

/// Extremes of the type, infinities and NaN among the samples.
template <class T>
void expectTheIndexsBlocks(std::uint64_t seed) {
    std::uint64_t state = seed;
    const Volume volume = hardSamples<T>(randomSize(state, 20), seed);
    for (const int blockSize : kBlockSizes) {
        for (const Border border : kBorders) {
            const SpanSpaceIndex index =
                SpanSpaceIndex::build(volume, {blockSize, border, BlockSearchKind::Linear});
            for (const double isovalue : {-1e30, -1.0, 0.0, 0.5, 3.0, 11.0, 12.0, 1e19, 1e30}) {
                const BlockQuery found = findBlocksAt(volume, index.grid(), isovalue);
                EXPECT_EQ(found.blocks, index.blocksAt(isovalue).blocks) << isovalue;
                EXPECT_EQ(found.nodesVisited, index.blocksAt(isovalue).nodesVisited) << isovalue;
            }
        }
    }
}

}  // namespace

TEST(FindBlocksAt, FindsWithoutAnIndexWhatOneFinds) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        expectTheIndexsBlocks<std::uint8_t>(seed);
        expectTheIndexsBlocks<std::int16_t>(seed);
        expectTheIndexsBlocks<std::uint64_t>(seed);
        expectTheIndexsBlocks<float>(seed);
        expectTheIndexsBlocks<double>(seed);
    }
}

TEST(SpanSpaceIndex, FindsTheBlocksThatAScanFinds) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        std::uint64_t state = seed;
        Index3 size;
        for (auto& extent : size) extent = 1 + static_cast<std::int64_t>(nextRandom(state) % 30);
        const Volume volume = randomVolume<std::int16_t>(size, 12, seed);
        for (const int blockSize : {2, 4, 8, 16}) {
            for (const Border border : {Border::Closed, Border::Open}) {
                const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {blockSize, border});
                for (const double isovalue : {-1.0, 0.0, 0.5, 3.0, 7.0, 10.5, 11.0, 12.0}) {
                    EXPECT_EQ(index.blocksAt(isovalue).blocks,
                              blocksByDefinition<std::int16_t>(volume, index.grid(), isovalue));
                }
            }
        }
    }
}

TEST(SpanSpaceIndex, TakesNotANumberAsOutside) {
    const float kNan = std::nanf("");
    ImageGeometry geometry;
    geometry.size = {3, 3, 3};
    std::vector<float> samples(27, 5.0F);
    samples[13] = kNan;
    const Volume volume = Volume::fromSamples(samples, geometry);
    const SpanSpaceIndex open = SpanSpaceIndex::build(volume, {2, Border::Open});
    EXPECT_EQ(open.blocksAt(4).blocks, blocksByDefinition<float>(volume, open.grid(), 4));
    EXPECT_TRUE(open.blocksAt(6).blocks.empty());
}

TEST(SpanSpaceIndex, KeepsTheExtremesOfATypeApart) {
    ImageGeometry geometry;
    geometry.size = {4, 4, 4};
    std::vector<std::uint8_t> samples(64, 0);
    samples[21] = 255;
    const Volume volume = Volume::fromSamples(samples, geometry);
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {2, Border::Closed});
    for (const double isovalue : {-5.0, 0.0, 0.001, 1.0, 254.5, 255.0, 255.5, 1e9}) {
        EXPECT_EQ(index.blocksAt(isovalue).blocks,
                  blocksByDefinition<std::uint8_t>(volume, index.grid(), isovalue))
            << isovalue;
    }
}

TEST(SpanSpaceIndex, VisitsFewNodesBesidesTheAnswer) {
    const AnalyticVolume truth =
        sampled<std::uint8_t>(sphere({}, 50), centredGeometry({128, 128, 128}));
    const SpanSpaceIndex index = SpanSpaceIndex::build(truth.volume, {4, Border::Closed});
    for (const double isovalue : {10.0, 40.0, 64.0, 100.0, 127.0}) {
        const BlockQuery query = index.blocksAt(isovalue);
        // 1.2 times the answer and the square root of all blocks
        EXPECT_LE(static_cast<double>(query.nodesVisited),
                  1.2 * static_cast<double>(query.blocks.size()) +
                      std::sqrt(static_cast<double>(index.grid().blockCount())))
            << isovalue;
    }
}

TEST(SpanSpaceIndex, HoldsFourSamplesAndANumberForEachBlock) {
    const Volume volume = randomVolume<std::uint8_t>({33, 33, 33}, 200, 1);
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {4, Border::Open});
    EXPECT_EQ(index.memoryBytes(), static_cast<std::size_t>(index.grid().blockCount()) * 8);
}

}  // namespace adaptiso::testing
