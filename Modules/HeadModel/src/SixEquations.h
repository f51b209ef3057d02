#pragma once

#include <array>
#include <optional>

namespace adaptiso {

/// Six linear equations: the coefficients of the unknowns, and the right side last.
using SixEquations = std::array<std::array<double, 7>, 6>;

/// Gauss's elimination with pivots. \return nullopt where the largest of a column is not above
/// `leastPivot`
std::optional<std::array<double, 6>> solved(SixEquations equations, double leastPivot);

}  // namespace adaptiso
