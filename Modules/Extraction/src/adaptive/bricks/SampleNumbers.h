#pragma once

#include <cstdint>
#include <vector>

#include "adaptive/bricks/Bricks.h"

namespace adaptiso::detail {

/// Numbers of samples: the vertices within a brick, not on its walls, in the order in which they
/// come when the brick is meshed whole. Finds them again when only some of its blocks are meshed.
class SampleNumbers {
public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    explicit SampleNumbers(const Bricks& bricks) : bricks_(bricks), first_(bricks.count()) {}

    /// \param fine  all of a brick's own surface; remembers where its blocks' samples begin
    /// \param numbers  of each of the brick's own vertices; kNone for those on walls
    void ofWhole(std::int64_t brick, const FineSurface& fine, std::vector<std::uint32_t>& numbers);

    /// \param fine  a part of a brick's own surface
    /// \param numbers  kNone also for vertices that come with a block that is not meshed
    /// \pre ofWhole() was called for the brick
    void ofPart(std::int64_t brick, const FineSurface& fine,
                std::vector<std::uint32_t>& numbers) const;

private:
    bool comesWith(std::uint32_t block, const FineVertex& vertex) const;

    const Bricks& bricks_;
    std::vector<std::vector<std::uint32_t>> first_;  ///< of each brick's blocks
};

}  // namespace adaptiso::detail
