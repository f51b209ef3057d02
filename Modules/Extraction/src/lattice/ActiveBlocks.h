#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso::detail {

/// Numbers the blocks that the isovalue touches 0, 1, ... in ascending block order, and finds the
/// number of a block in constant time (a bit a block and a running count a word).
class ActiveBlocks {
public:
    static constexpr std::int64_t kNone = -1;

    /// \param blocks  ascending block numbers of the grid
    ActiveBlocks(const BlockGrid& grid, std::vector<std::uint32_t> blocks)
        : grid_(grid), blocks_(std::move(blocks)), words_((grid.blockCount() + 63) / 64) {
        for (const std::uint32_t b : blocks_) words_[b / 64].bits |= std::uint64_t{1} << (b % 64);
        std::uint32_t total = 0;
        for (Word& w : words_) {
            w.before = total;
            total += static_cast<std::uint32_t>(std::popcount(w.bits));
        }
    }

    const BlockGrid& grid() const { return grid_; }
    std::int64_t count() const { return static_cast<std::int64_t>(blocks_.size()); }
    std::uint32_t block(std::int64_t active) const { return blocks_[active]; }

    /// The active number of the block `steps` away from an active block, or kNone.
    std::int64_t neighbour(std::int64_t active, const std::array<int, 3>& steps) const {
        const std::int64_t b = blocks_[active];
        const Index3& n = grid_.blocks;
        const std::int64_t x = b % n[0] + steps[0], y = b / n[0] % n[1] + steps[1],
                           z = b / (n[0] * n[1]) + steps[2];
        if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) return kNone;
        return find(x + n[0] * (y + n[1] * z));
    }

private:
    struct Word {
        std::uint64_t bits = 0;
        std::uint32_t before = 0;
    };

    std::int64_t find(std::int64_t block) const {
        const Word& w = words_[block / 64];
        const std::uint64_t bit = std::uint64_t{1} << (block % 64);
        if ((w.bits & bit) == 0) return kNone;
        return w.before + std::popcount(w.bits & (bit - 1));
    }

    BlockGrid grid_;
    std::vector<std::uint32_t> blocks_;
    std::vector<Word> words_;
};

}  // namespace adaptiso::detail
