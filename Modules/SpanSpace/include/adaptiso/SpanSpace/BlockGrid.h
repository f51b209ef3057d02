#pragma once

#include <cstdint>

#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso {

/// Treatment of a surface at the border of the volume.
enum class Border {
    Closed,  ///< closed, as if a layer of outside samples lay around the volume
    Open     ///< left open there
};

/// Division of a volume into initial blocks of N x N x N cells, (N+1)^3 samples; neighbours share
/// a layer of samples (thesis, chapter 3).
///
/// Blocks lie in a lattice that starts at sample index -offset: in a closed grid one layer of
/// blocks holds the virtual outside samples before index 0, so that the blocks inside the volume
/// lie at the same samples whether the border is closed or open.
struct BlockGrid {
    int blockSize = 4;  ///< N: 2, 4, 8 or 16
    Border border = Border::Closed;
    Index3 volumeSize{0, 0, 0};  ///< samples of the volume
    Index3 blocks{0, 0, 0};      ///< blocks along i, j, k
    std::int64_t offset = 0;     ///< lattice position of sample 0 along every axis

    /// \throws InvalidInput when blockSize is not 2, 4, 8 or 16, or there are 2^32 blocks or more
    static BlockGrid make(const Index3& volumeSize, int blockSize, Border border);

    std::int64_t blockCount() const { return blocks[0] * blocks[1] * blocks[2]; }

    /// Sample index of the first sample of a block along each axis (may be negative).
    Index3 firstSample(std::uint32_t block) const {
        return {static_cast<std::int64_t>(block) % blocks[0] * blockSize - offset,
                static_cast<std::int64_t>(block) / blocks[0] % blocks[1] * blockSize - offset,
                static_cast<std::int64_t>(block) / (blocks[0] * blocks[1]) * blockSize - offset};
    }

    friend bool operator==(const BlockGrid&, const BlockGrid&) = default;
};

}  // namespace adaptiso
