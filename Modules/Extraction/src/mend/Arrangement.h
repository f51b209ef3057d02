#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "mend/CutTriangle.h"
#include "mend/MendInput.h"

namespace adaptiso::detail {

/// Numbers points by their place.
class PointPlaces {
public:
    /// \return  the first point that was given for the place
    CutTriangle::Id add(const Vec3& p, CutTriangle::Id number) {
        return first_.try_emplace({p.x + 0.0, p.y + 0.0, p.z + 0.0}, number).first->second;
    }

private:
    std::map<std::array<double, 3>, CutTriangle::Id> first_;
};

/// A mesh cut along all lines where its triangles meet [Zhou2016]: its triangles then have corners
/// and edges in common alone.
struct Arrangement {
    std::vector<std::array<CutTriangle::Id, 3>> triangles;  ///< of the mesh's points and new ones
    std::vector<std::uint32_t> origin;  ///< of each, the mesh's triangle, ascending
    std::vector<std::uint8_t> isCut;    ///< of the mesh's
};

/// Whether triangles meet is decided by orient3d() and orient2d(), but that what lies within
/// `nearMm` touches. New points are rounded, so that those of different triangles may cross again.
/// \param mesh    with its edges; gets new points. Points of triangles that meet, at one place, are
///                one in the arrangement
/// \param pairs   of triangles, that cross. Triangles at borders are looked at as well
/// \return  none where rounding leaves it open how a triangle is cut, or too many pairs lie near
std::optional<Arrangement> arrange(MendInput& mesh,
                                   const std::vector<std::array<std::uint32_t, 2>>& pairs,
                                   double nearMm);

}  // namespace adaptiso::detail
