#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// Number of the first point at the place of each.
std::vector<VertexId> firstAtPlace(const std::vector<Vec3>& points);

/// Triangles of a mesh whose corners lie where those of another do.
struct DoubledTriangles {
    std::vector<std::uint8_t> isDropped;  ///< of each triangle
    std::vector<std::size_t> walls;       ///< one of each wall of solids that touch
};

/// Finds triangles to drop. Of triangles at one place one stays, which faces as most of them do. Of
/// a wall between solids that touch none stays. A closed part that this would open keeps all.
DoubledTriangles findDoubled(const std::vector<Vec3>& points,
                             const std::vector<Triangle>& triangles);

}  // namespace adaptiso::detail
