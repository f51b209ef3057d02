#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/detail/PlanarTriangulation.h"

namespace adaptiso::detail {

/// A connected plane region: its loops, by number, and the triangles that fill it.
struct PlanarGroup {
    std::vector<std::size_t> loops;
    std::vector<Triangle> triangles;
};

/// Points of a plane polygon that lie on a line, but for rounding, are joined by none of its
/// triangles: edges are flipped while that makes the worse of two triangles better.
void flipSlivers(const std::vector<Vec3>& points, const Vec3& normal,
                 std::vector<Triangle>& triangles);

/// Fills loops of points that lie in the plane of a triangle, but for rounding.
class PlanarFiller {
public:
    /// \param loops  of point numbers, the inside on the left seen from the triangle's front
    /// \return  none where the loops bound no plane region
    std::optional<std::vector<PlanarGroup>> fill(const std::vector<Vec3>& points,
                                                 const Corners& plane,
                                                 const std::vector<std::vector<VertexId>>& loops);

private:
    PlanarTriangulator triangulator_;
};

}  // namespace adaptiso::detail
