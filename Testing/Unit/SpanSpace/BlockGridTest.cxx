#include <gtest/gtest.h>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso {

TEST(BlockGrid, HoldsAClosedVolumeWithALayerOfOutsideSamples) {
    // 256 samples, one outside at either end: lattice 3 .. 260 in blocks of 4 from lattice 0
    const BlockGrid grid = BlockGrid::make({256, 255, 253}, 4, Border::Closed);
    EXPECT_EQ(grid.offset, 4);
    EXPECT_EQ(grid.blocks, (Index3{65, 65, 65}));
    EXPECT_EQ(grid.firstSample(0), (Index3{-4, -4, -4}));
    EXPECT_EQ(grid.firstSample(1 + 65 * (2 + 65 * 3)), (Index3{0, 4, 8}));
}

TEST(BlockGrid, StartsAtTheFirstSampleOfAnOpenVolume) {
    const BlockGrid grid = BlockGrid::make({256, 257, 1}, 4, Border::Open);
    EXPECT_EQ(grid.offset, 0);
    EXPECT_EQ(grid.blocks, (Index3{64, 65, 1}));
    EXPECT_EQ(grid.firstSample(0), (Index3{0, 0, 0}));
}

TEST(BlockGrid, RefusesOddBlockSizes) {
    for (const int size : {-4, 0, 1, 3, 6, 32}) {
        EXPECT_THROW(BlockGrid::make({8, 8, 8}, size, Border::Closed), InvalidInput) << size;
    }
}

TEST(BlockGrid, RefusesMoreBlocksThanItCanNumber) {
    EXPECT_THROW(BlockGrid::make({4096, 4096, 4096}, 2, Border::Closed), InvalidInput);
    EXPECT_NO_THROW(BlockGrid::make({4096, 4096, 4096}, 4, Border::Closed));
}

}  // namespace adaptiso
