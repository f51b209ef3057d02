#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::testing {

using IntPoint = std::array<std::int64_t, 3>;

/// Triangles between points of whole coordinates, so that who crosses whom can be said exactly,
/// without any of the library's code.
struct IntegerSoup {
    std::vector<IntPoint> points;
    std::vector<std::array<int, 3>> triangles;

    TriangleMesh mesh() const;
    Corners corners(int t) const;

    /// Two triangles cross: an edge of one passes through the inside of the other, or runs in its
    /// plane. Corners that both share are not looked at.
    /// \return nothing where four points of theirs lie in one plane
    std::optional<bool> cross(int s, int t) const;
};

/// \param triangles  between any of the points
IntegerSoup randomSoup(std::mt19937& random, int points, int triangles, std::int64_t halfSide);

}  // namespace adaptiso::testing
