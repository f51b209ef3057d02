#include "adaptiso/SpanSpace/BlockGrid.h"

#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

BlockGrid BlockGrid::make(const Index3& volumeSize, int blockSize, Border border) {
    if (blockSize != 2 && blockSize != 4 && blockSize != 8 && blockSize != 16) {
        throw InvalidInput("BlockGrid: block size " + std::to_string(blockSize) +
                           ", must be 2, 4, 8 or 16");
    }
    BlockGrid grid{blockSize, border, volumeSize, {0, 0, 0}, 0};
    double count = 1;
    if (border == Border::Closed) grid.offset = blockSize;
    for (int axis = 0; axis < 3; ++axis) {
        // every lattice position that can hold the lower end of a crossed edge lies in a block:
        // up to the last sample, whose edge to the virtual layer may be crossed
        const std::int64_t last = grid.offset + volumeSize[axis] - 1;
        grid.blocks[axis] = last / blockSize + 1;
        count *= static_cast<double>(grid.blocks[axis]);
    }
    if (count >= 4294967296.0) {
        throw InvalidInput("the image has 2^32 or more blocks of " + std::to_string(blockSize) +
                           " voxels a side; take a larger block size");
    }
    return grid;
}

}  // namespace adaptiso
