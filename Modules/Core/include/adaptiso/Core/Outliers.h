#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace adaptiso {

/// Which values lie apart from the others.
struct OutlierRule {
    double limit = 3.5;       ///< robust standard deviations from the median
    double leastPercent = 1;  ///< of the median; nearer values are no outliers

    /// "more than 3.5 robust standard deviations (1.4826 times the median distance from the median)
    /// and at least 1 % from the median"
    std::string text() const;
};

struct Outlier {
    std::size_t index;  ///< of the value
    double score;       ///< robust standard deviations from the median
    double percent;     ///< of the median; infinite where that is 0

    std::string percentText() const;  ///< "+31%", "-0.52%"
};

/// The outliers among `values`, in their order; values that are missing or not finite are ignored.
///
/// The modified z-score [IglewiczHoaglin1993]: (x - median) / (1.4826 MAD), MAD being the median
/// distance from the median; where more than half of the values are equal, so that it is 0, the
/// mean distance times 1.2533 replaces it. Up to half of the values may be wrong without moving the
/// scale much.
/// \return  empty if fewer than kFewestCompared values are there, or all are equal
std::vector<Outlier> findOutliers(std::span<const std::optional<double>> values,
                                  const OutlierRule& rule = {});

inline constexpr std::size_t kFewestCompared = 5;  ///< of four, one is no exception

/// The values that are there and finite.
std::vector<double> knownOf(std::span<const std::optional<double>> values);

/// \pre values is not empty
double medianOf(std::vector<double> values);

}  // namespace adaptiso
