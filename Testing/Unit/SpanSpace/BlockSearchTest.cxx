#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "BlocksByDefinition.h"

// The ways to search an index: the same answer, and what each of them looks at for it.

namespace adaptiso::testing {

template <class T>
class BlockSearch : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(BlockSearch, PixelTypes);

namespace {

/// Below, at, between and above the samples of hardSamples(), and beyond what a type holds.
std::vector<double> hardIsovalues() {
    return {-1e300, -1e9, -128, -1, 0, 0.5, 3, 7, 10.5, 11, 11.5, 127, 255, 1e9, 1e300};
}

SpanSpaceIndex indexOf(const VolumeView& volume, BlockSearchKind search, int blockSize,
                       Border border = Border::Open) {
    return SpanSpaceIndex::build(volume, {blockSize, border, search});
}

/// uint8 samples of value 0 but for one of 9.
Volume loneSample(const Index3& size, const Index3& place) {
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(geometry.voxelCount()), 0);
    samples[place[0] + size[0] * (place[1] + size[1] * place[2])] = 9;
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Bound of the kd-tree's visits: 1.2 times the answer and the square root of all blocks.
double grantedVisits(const SpanSpaceIndex& index, const BlockQuery& query) {
    return 1.2 * static_cast<double>(query.blocks.size()) +
           std::sqrt(static_cast<double>(index.grid().blockCount()));
}

}  // namespace

TYPED_TEST(BlockSearch, EveryKindFindsTheBlocksByDefinitionInTheirOrder) {
    std::uint64_t state = 7;
    for (int n = 0; n < 12; ++n) {
        const Volume volume = hardSamples<TypeParam>(randomSize(state, 24), nextRandom(state));
        for (const int blockSize : kBlockSizes) {
            for (const Border border : kBorders) {
                const SpanSpaceIndex linear =
                    indexOf(volume, BlockSearchKind::Linear, blockSize, border);
                const SpanSpaceIndex octree =
                    indexOf(volume, BlockSearchKind::Octree, blockSize, border);
                const SpanSpaceIndex kdTree =
                    indexOf(volume, BlockSearchKind::KdTree, blockSize, border);
                for (const double isovalue : hardIsovalues()) {
                    SCOPED_TRACE(isovalue);
                    const auto truth =
                        blocksByDefinition<TypeParam>(volume, linear.grid(), isovalue);
                    EXPECT_EQ(linear.blocksAt(isovalue).blocks, truth);
                    EXPECT_EQ(octree.blocksAt(isovalue).blocks, truth);
                    EXPECT_EQ(kdTree.blocksAt(isovalue).blocks, truth);
                }
            }
        }
    }
}

TEST(LinearScan, LooksAtEveryBlockForEveryAnswer) {
    const Volume volume = loneSample({16, 16, 16}, {5, 7, 9});
    const SpanSpaceIndex index = indexOf(volume, BlockSearchKind::Linear, 2);
    for (const double isovalue : {0.5, 9.0, 200.0}) {
        EXPECT_EQ(index.blocksAt(isovalue).nodesVisited, 8 * 8 * 8) << isovalue;
    }
    EXPECT_EQ(index.memoryBytes(), 8u * 8 * 8 * 2);
}

TEST(MinMaxOctree, GoesDownToALoneBlockAlongOneBranch) {
    // an odd sample lies in one block only: 8 x 8 x 8 blocks, the root, and 8 children thrice
    const Volume volume = loneSample({16, 16, 16}, {5, 7, 9});
    const SpanSpaceIndex index = indexOf(volume, BlockSearchKind::Octree, 2);
    const BlockQuery query = index.blocksAt(5);
    EXPECT_EQ(query.blocks, (std::vector<std::uint32_t>{2 + 8 * (3 + 8 * 4)}));
    EXPECT_EQ(query.nodesVisited, 1 + 3 * 8);
    EXPECT_EQ(index.blocksAt(10).nodesVisited, 1);  // the root knows that no sample reaches 10
}

TEST(MinMaxOctree, BranchesOnNeedOnly) {
    // 5 x 3 x 1 blocks, then 3 x 2 x 1, 2 x 1 x 1 and the root: 24 nodes of two bytes
    const Volume volume = loneSample({10, 6, 2}, {9, 5, 1});
    const SpanSpaceIndex index = indexOf(volume, BlockSearchKind::Octree, 2);
    EXPECT_EQ(index.memoryBytes(), 24u * 2);
    const BlockQuery query = index.blocksAt(5);
    EXPECT_EQ(query.blocks, (std::vector<std::uint32_t>{14}));
    // root; its 2 children; the 2 of the second (2, 0), (2, 1); the 1 block of the latter
    EXPECT_EQ(query.nodesVisited, 1 + 2 + 2 + 1);
}

TEST(MinMaxOctree, HoldsASeventhMoreThanItsBlocks) {
    // 32^3 blocks and 16^3 + 8^3 + ... + 1 nodes above them
    const Volume volume = randomVolume<std::uint16_t>({64, 64, 64}, 9, 3);
    const SpanSpaceIndex index = indexOf(volume, BlockSearchKind::Octree, 2);
    EXPECT_EQ(index.memoryBytes(), (32768u + 4096 + 512 + 64 + 8 + 1) * 4);
}

TEST(KdTree, LooksAtTheNodesThatPaperSays) {
    // a ramp of 7 blocks in a row, block b from 2b to 2b + 2: at 5 the root, block 3, begins too
    // late; block 1 of the left half ends too early; block 2, on its right, is the answer
    ImageGeometry geometry;
    geometry.size = {14, 1, 1};
    std::vector<std::int16_t> samples(14);
    std::iota(samples.begin(), samples.end(), std::int16_t{0});
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const BlockQuery query = indexOf(volume, BlockSearchKind::KdTree, 2).blocksAt(5);
    EXPECT_EQ(query.blocks, (std::vector<std::uint32_t>{2}));
    EXPECT_EQ(query.nodesVisited, 3);
    // the octree: the root; blocks 0..3 and 4..6; 0..1 and 2..3; 2 and 3
    EXPECT_EQ(indexOf(volume, BlockSearchKind::Octree, 2).blocksAt(5).nodesVisited, 1 + 2 + 2 + 2);
}

TEST(KdTree, VisitsWithinItsGrantOnSolids) {
    const ImageGeometry geometry = centredGeometry({96, 96, 96});
    const Shape shapes[] = {sphere({}, 38), torus({}, 28, 11), shell({}, 18, 36),
                            box({}, {30, 20, 36})};
    for (const Shape& shape : shapes) {
        const AnalyticVolume truth = sampled<std::uint8_t>(shape, geometry);
        for (const int blockSize : {2, 4}) {  // with hundreds of blocks only, log n counts too
            for (const Border border : kBorders) {
                const SpanSpaceIndex index =
                    indexOf(truth.volume, BlockSearchKind::KdTree, blockSize, border);
                for (const double isovalue : {20.0, 40.0, 64.0, 80.0, 100.0}) {
                    const BlockQuery query = index.blocksAt(isovalue);
                    EXPECT_LE(static_cast<double>(query.nodesVisited), grantedVisits(index, query))
                        << isovalue << " at block size " << blockSize;
                }
            }
        }
    }
}

TEST(KdTree, VisitsWithinItsGrantWhereFewBlocksAnswer) {
    // a head, as the index sees it: dark ground, tissue of many values, one bright voxel. Above the
    // tissue eight blocks answer; a walk that knows nothing of the subtrees would look at 2.5
    // sqrt(n) nodes along the ground and the brightest tissue
    const ImageGeometry geometry = centredGeometry({96, 96, 96});
    std::vector<std::uint8_t> samples(96 * 96 * 96, 0);
    const auto fromMiddle = [](std::size_t n) { return static_cast<double>(n % 96) - 47.5; };
    std::uint64_t state = 5;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const Vec3 p{fromMiddle(n), fromMiddle(n / 96), fromMiddle(n / 9216)};
        if (dot(p, p) < 40 * 40) samples[n] = static_cast<std::uint8_t>(nextRandom(state) % 120);
    }
    samples[48 * (1 + 96 + 9216)] = 200;  // a corner of blocks of every size
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    for (const int blockSize : {2, 4}) {
        for (const Border border : kBorders) {
            const SpanSpaceIndex index =
                indexOf(volume, BlockSearchKind::KdTree, blockSize, border);
            EXPECT_EQ(index.blocksAt(150).blocks.size(), 8u);
            for (int isovalue = 1; isovalue < 256; ++isovalue) {
                const BlockQuery query = index.blocksAt(isovalue);
                EXPECT_LE(static_cast<double>(query.nodesVisited), grantedVisits(index, query))
                    << isovalue << " at block size " << blockSize;
            }
        }
    }
}

TEST(KdTree, VisitsFewNodesInVainWhateverTheVolume) {
    // A specialised walk goes both ways on every other level only, so of m nodes it looks at no
    // more than 1 + 2 + 2 + 4 + 4 + ... <= 3 sqrt(2 m) in vain. `search` starts one on each of its
    // levels at most, over n/2, n/4, ... nodes, the roots of which add up to less than 2.42
    // sqrt(n): 10.3 sqrt(n) in all, and a node a level of its own.
    std::uint64_t state = 11;
    for (int n = 0; n < 40; ++n) {
        const Volume volume =
            randomVolume<std::uint16_t>(randomSize(state, 48), 5000, nextRandom(state));
        for (const Border border : kBorders) {
            const SpanSpaceIndex index = indexOf(volume, BlockSearchKind::KdTree, 2, border);
            const auto all = static_cast<double>(index.grid().blockCount());
            for (double isovalue = 0.5; isovalue < 5000; isovalue += 250) {
                const BlockQuery query = index.blocksAt(isovalue);
                EXPECT_LE(static_cast<double>(query.nodesVisited - std::ssize(query.blocks)),
                          10.3 * std::sqrt(all) + std::log2(all) + 1)
                    << isovalue;
            }
        }
    }
}

}  // namespace adaptiso::testing
