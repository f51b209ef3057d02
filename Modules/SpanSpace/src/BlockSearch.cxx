#include "BlockSearch.h"

#include <algorithm>
#include <bit>

namespace adaptiso::detail {

void sortBlocks(std::vector<std::uint32_t>& blocks, std::int64_t blockCount) {
    if (std::ssize(blocks) < blockCount / 64) {
        std::sort(blocks.begin(), blocks.end());
        return;
    }
    std::vector<std::uint64_t> words((blockCount + 63) / 64, 0);
    for (const std::uint32_t b : blocks) words[b / 64] |= std::uint64_t{1} << (b % 64);
    auto next = blocks.begin();
    for (std::size_t w = 0; w < words.size(); ++w) {
        for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
            *next++ = static_cast<std::uint32_t>(w * 64 + std::countr_zero(bits));
        }
    }
}

}  // namespace adaptiso::detail
