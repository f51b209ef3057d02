#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace adaptiso::detail {

/// What finds the blocks that a threshold touches: one contract, so that the ways to search can
/// stand in for each other and be compared.
template <class T>
class BlockSearch {
public:
    virtual ~BlockSearch() = default;

    /// Puts the blocks with minimum < threshold <= maximum into `found`, ascending.
    /// \pre `found` is empty   \return nodes looked at
    virtual std::int64_t search(T threshold, std::vector<std::uint32_t>& found) const = 0;

    /// Bytes held beside the object itself.
    virtual std::size_t memoryBytes() const = 0;
};

/// Sorts distinct block numbers < blockCount, in O(blocks.size() + blockCount / 64) where there are
/// many: through a bit a block.
void sortBlocks(std::vector<std::uint32_t>& blocks, std::int64_t blockCount);

}  // namespace adaptiso::detail
