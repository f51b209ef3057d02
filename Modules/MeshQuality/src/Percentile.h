#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace adaptiso {

/// The nearest-rank percentile: the smallest value that `part` (0 to 1) of them do not exceed.
/// Reorders `values`. \pre there is one
inline double percentile(std::vector<double>& values, double part) {
    const auto rank =
        static_cast<std::ptrdiff_t>(std::ceil(part * static_cast<double>(values.size())));
    const auto place = values.begin() + std::clamp<std::ptrdiff_t>(rank - 1, 0, values.size() - 1);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

}  // namespace adaptiso
