#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// Boxes that are all gone through for each question, several at once: some thousand take a
/// microsecond or two, and no tree has to be made. In single precision, rounded outward.
class BoxList {
public:
    bool isEmpty() const { return low_[0].empty(); }
    void clear() {
        for (int a = 0; a < 3; ++a) low_[a].clear(), high_[a].clear();
    }
    void add(const BoundingBox& box) {
        for (int a = 0; a < 3; ++a) {
            low_[a].push_back(floatBelow(box.minimum[a]));
            high_[a].push_back(floatAbove(box.maximum[a]));
        }
    }

    /// Calls f(number) for the boxes that overlap one, or nearly, in ascending order.
    template <class F>
    void forEachOverlap(const BoundingBox& box, const F& f) const {
        constexpr std::size_t kAtOnce = 256;
        std::array<float, kAtOnce> apart;  // above 0 where they do not overlap
        const std::size_t count = low_[0].size();
        for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
            const std::size_t here = std::min(kAtOnce, count - begin);
            for (int a = 0; a < 3; ++a) {
                const float *low = low_[a].data() + begin, *high = high_[a].data() + begin;
                const float lowest = floatBelow(box.minimum[a]),
                            highest = floatAbove(box.maximum[a]);
                for (std::size_t i = 0; i < here; ++i) {
                    const float gap = std::max(low[i] - highest, lowest - high[i]);
                    apart[i] = a == 0 ? gap : std::max(apart[i], gap);
                }
            }
            for (std::size_t i = 0; i < here; ++i) {
                if (apart[i] <= 0) f(begin + i);
            }
        }
    }

private:
    std::array<std::vector<float>, 3> low_, high_;  ///< by axis
};

}  // namespace adaptiso::detail
