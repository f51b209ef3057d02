#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// A mesh's triangles without those that have no area, as far as can be without opening the
/// surface: vertices at one place that such a triangle joins become one, and those of its shortest
/// edge where they lie as near as 1e-9 of its longest one and the surface stays what it is
/// [Dey1999]; where a corner lies on the opposite side the neighbour across that side is split
/// there. What none of these serves is left out.
struct AreaTriangles {
    // both empty where all have an area, as most meshes' do: they are the mesh's own then
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> isLeftOut;  ///< of each
    std::int64_t flat = 0;                ///< how many had no area
    double movedMm = 0;                   ///< no vertex was farther from the one that it became
};

/// \param mayMoveMm  as far as movedMm may be
/// \pre indices are in range
AreaTriangles withoutFlatTriangles(const TriangleMesh& mesh, double mayMoveMm);

}  // namespace adaptiso::detail
