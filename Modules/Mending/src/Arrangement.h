#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "CutTriangle.h"
#include "MendInput.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// A mesh cut along all lines where its triangles meet [Zhou2016]: its triangles then have corners
/// and edges in common alone.
struct Arrangement {
    std::vector<std::array<CutTriangle::Id, 3>> triangles;  ///< of the mesh's points and new ones
    std::vector<std::uint32_t> origin;  ///< of each, the mesh's triangle, ascending
    std::vector<std::uint8_t> isCut;    ///< of the mesh's: it is not there as it was
    double movedMm = 0;                 ///< how far a corner moved to be one with another
};

/// orient3d() and orient2d() decide whether triangles meet. What lies within `nearMm` of another
/// touches it. New points are rounded, so that those of different triangles may cross again.
/// \param mesh    with its edges; gets new points. In the arrangement, points that lie near each
///                other are one
/// \param pairs   of triangles, that cross. Triangles at borders are looked at as well
/// \return  none where rounding leaves it open how a triangle is cut, or too many pairs lie near
std::optional<Arrangement> arrange(MendInput& mesh,
                                   const std::vector<std::array<std::uint32_t, 2>>& pairs,
                                   double nearMm);

}  // namespace adaptiso::detail
