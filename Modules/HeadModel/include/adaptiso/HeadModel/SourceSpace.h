#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Places of current dipoles: vertices of a surface of the cortex, or points of a grid.
struct SourceSpace {
    /// LPS mm, with normals; of a grid all of its points, x fastest, and no triangle.
    TriangleMesh surface;
    std::vector<std::int64_t> used;       ///< numbers of the points that are sources, ascending
    std::optional<ImageGeometry> grid{};  ///< LPS mm
    bool isOpen = false;                  ///< the surface has a boundary: normals are as given

    /// Unit dipoles: along the normal or, of a grid, along each axis.
    std::vector<Vec3> orientations(std::int64_t point) const;
};

/// Sources at `count` vertices spread evenly over a surface: each next one is the vertex that lies
/// farthest, along edges, from those taken [Eldar1997]. All vertices where there are no more; those
/// of no triangle are left out. A closed surface that is inside out is turned; an open one
/// has no inside and keeps its orientation.
/// Cost: O(V log V log count), V vertices. \pre count > 0
SourceSpace surfaceSources(TriangleMesh surface, std::int64_t count);

/// Sources at the points of a cubic grid (multiples of `stepMm`) that lie within a closed surface,
/// at least one of its edges away. \pre stepMm > 0
SourceSpace gridSources(const TriangleMesh& compartment, double stepMm);

/// Changes by keepWithin().
struct SourceMoves {
    std::int64_t moved = 0, dropped = 0;
    std::int64_t outside = 0;           ///< lay outside by more than 0.5 mm; moved or dropped
    double meanMm = 0, farthestMm = 0;  ///< of the moved
};

/// Moves sources nearer to a closed surface than one edge away from it, the shortest way inwards,
/// until they are one edge away: boundary elements resolve no less. Those farther out than one
/// edge, and those that find no such place, are dropped. The edge is the mean of the nearest
/// triangle's three.
SourceMoves keepWithin(SourceSpace& sources, const TriangleMesh& compartment);

/// How many points lie outside a closed surface, by more than 0.5 mm.
std::int64_t pointsOutside(const std::vector<Vec3>& pointsMm, const TriangleMesh& surface);

}  // namespace adaptiso
