#include "TriangleGrid.h"

#include <cmath>

namespace adaptiso::detail {

SpaceCells::SpaceCells(const BoundingBox& box, double cellMm, std::int64_t most)
    : low_(box.minimum) {
    const Vec3 side = box.size();
    const double longest = std::max({side.x, side.y, side.z});
    double cell = std::max(cellMm, 1e-6 * longest);
    if (!(cell > 0)) return;  // a point
    for (;; cell *= 1.25) {
        perMm_ = 1 / cell;
        for (int axis = 0; axis < 3; ++axis) {
            size_[axis] = static_cast<std::int64_t>(side[axis] * perMm_) + 1;
        }
        if (count() <= most) return;
    }
}

SpaceCells::Range SpaceCells::rangeOf(const BoundingBox& box) const {
    Range range;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](double x) {
            const double last = static_cast<double>(size_[axis] - 1);
            return static_cast<std::int64_t>(std::clamp((x - low_[axis]) * perMm_, 0.0, last));
        };
        range[axis] = {at(box.minimum[axis]), at(box.maximum[axis])};
    }
    return range;
}

}  // namespace adaptiso::detail
