#pragma once

#include <optional>
#include <span>
#include <vector>

namespace adaptiso {

/// The median of the values that are there; NaN where none is.
double medianOf(std::span<const std::optional<double>> values);

/// Returns the distance of each value from the median, in robust standard deviations.
///
/// The modified z-score [IglewiczHoaglin1993]: (x - median) / (1.4826 MAD), MAD being the median
/// distance from the median; where more than half of the values are equal, so that it is 0, the
/// mean distance times 1.2533 stands in its place. Half of the values may be wrong without moving
/// the scale much, which a mean and its standard deviation do not survive.
/// \return  empty for a missing value; all empty if fewer than 5 values are there, or all are equal
std::vector<std::optional<double>> robustScores(std::span<const std::optional<double>> values);

}  // namespace adaptiso
