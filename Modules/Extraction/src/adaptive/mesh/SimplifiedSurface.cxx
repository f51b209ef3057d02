#include "adaptive/mesh/SimplifiedSurface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <unordered_map>

namespace adaptiso::detail {

void removeTriangles(std::vector<SurfaceState::Number> gone, SurfaceState& surface,
                     SurfaceChanges& changes) {
    if (gone.empty()) return;
    std::sort(gone.begin(), gone.end(), std::greater());
    std::unordered_map<SurfaceState::Number, SurfaceState::Number> renumbered;
    for (const SurfaceState::Number t : gone) {
        const auto last = static_cast<SurfaceState::Number>(surface.triangles.size() - 1);
        if (t != last) {
            surface.triangles[t] = surface.triangles[last];
            renumbered[last] = t;
            changes.triangles.push_back(t);
        }
        surface.triangles.pop_back();
    }
    for (SurfaceState::Number& t : surface.sampleTriangle) {
        while (t >= surface.triangles.size()) t = renumbered.at(t);
    }
}

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
