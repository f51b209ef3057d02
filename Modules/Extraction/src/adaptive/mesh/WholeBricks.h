#pragma once

#include <cstdint>
#include <vector>

#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// The bricks in which a surface is still the full-resolution one, triangle by triangle: those that
/// were left whole (SimplifiedSurface::prints), as far as no later step has changed them.
///
/// Found by the triangles alone: what lies in the brick is as many triangles with the same sum over
/// their coordinates. Nothing is believed of the steps between.
///
/// Cost: O(T), in parallel; nothing where no brick was left whole. Keeps 4 bytes a triangle and no
/// reference to the surface.
class WholeBricks {
public:
    WholeBricks() = default;
    WholeBricks(const SimplifiedSurface& surface, const Bricks& bricks, const MetricFrame& frame);

    bool isAny() const { return isAny_; }
    /// The surface is the full-resolution one.
    bool areAll() const { return areAll_; }
    bool isWhole(std::int64_t brick) const { return isAny_ && isWhole_[brick] != 0; }
    /// The triangle lies in a brick that is whole: it is one of the full-resolution surface.
    bool isFine(std::uint64_t triangle) const {
        return isAny_ && brickOf_[triangle] != kNone && isWhole_[brickOf_[triangle]] != 0;
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    bool isAny_ = false, areAll_ = false;
    std::vector<std::uint32_t> brickOf_;  ///< of each triangle, if one that was left whole
    std::vector<std::uint8_t> isWhole_;   ///< of each brick
};

}  // namespace adaptiso::detail
