#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// A mesh's triangles without those that have no area, as far as can be without opening the
/// surface: vertices at one place that such a triangle joins become one; where a corner lies on the
/// opposite side the neighbour across that side is split there. What neither serves is left out.
struct AreaTriangles {
    // both empty where all have an area, as most meshes' do: they are the mesh's own then
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> isLeftOut;  ///< of each
    std::int64_t flat = 0;                ///< how many had no area
};

/// \pre indices are in range
AreaTriangles withoutFlatTriangles(const TriangleMesh& mesh);

}  // namespace adaptiso::detail
