#include "adaptive/mesh/SimplifiedSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adaptiso::detail {

double costLimitFor(const CollapseCosts& costs, std::int64_t collapses) {
    // a patch stops for good at its first collapse above the limit: what counts is the largest so
    // far
    std::vector<double> largestSoFar;
    for (const std::vector<double>& patch : costs) {
        double largest = 0;
        for (const double cost : patch) {
            largest = std::max(largest, cost);
            largestSoFar.push_back(largest);
        }
    }
    if (static_cast<std::int64_t>(largestSoFar.size()) <= collapses) {
        return std::numeric_limits<double>::max();
    }
    const auto first = largestSoFar.begin() + collapses;  // the first one too many
    std::nth_element(largestSoFar.begin(), first, largestSoFar.end());
    return std::nextafter(*first, 0.0);
}

}  // namespace adaptiso::detail
