#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Which connected pieces of a surface to keep.
///
/// A closed surface is read as the boundary of solid pieces: a component that encloses a positive
/// volume is the outer wall of a piece; one that encloses a negative volume (its outside is inside
/// it) is a cavity of the piece around it; a piece may lie loose inside a cavity. The volume of a
/// piece is that of its material: its outer wall's less that of its cavities.
///
/// The steps are taken in this order:
/// 1. fillCavities: every cavity goes, and with it all that lies inside it;
/// 2. minVolumeMm3: a cavity that encloses less goes (with all that lies inside it), then a piece
///    with less material goes, with its cavities. A piece loose inside one of those stays if it is
///    large enough itself;
/// 3. largestOnly: of what is left, the piece with the most material stays, with its cavities (the
///    first in the mesh's order where two are equal).
struct ComponentSelection {
    bool largestOnly = false;
    double minVolumeMm3 = 0;  ///< 0: no bound
    bool fillCavities = false;

    bool keepsAll() const { return !largestOnly && minVolumeMm3 == 0 && !fillCavities; }
};

/// --largest, --min-volume and --fill-cavities
const Options<ComponentSelection>& pieceOptions();

/// The part of `mesh` that `selection` keeps: vertices, normals and triangles in their old order,
/// without unused vertices. Empty when nothing is large enough.
///
/// Components are joined through shared vertices. Which component lies in which is found by rays
/// along z with exact integer predicates (points are rounded to 2^-30 of the mesh's extent for
/// this), by the majority of five points of each component, so that surfaces that touch or that
/// cross in a few triangles are read right as well.
///
/// An open surface (one with an edge of a single triangle) encloses nothing: there largestOnly
/// keeps the component of the largest area.
///
/// \pre  minVolumeMm3 >= 0; the mesh is closed unless largestOnly alone is asked for
///       \throws InvalidInput otherwise
/// Cost: O(T log T + C t) for T triangles, C components, t of them above or below one point.
TriangleMesh selectComponents(const TriangleMesh& mesh, const ComponentSelection& selection);

/// Which triangles selectComponents() keeps: 1, else 0. Preconditions, errors and cost are its own.
std::vector<std::uint8_t> keptTriangles(const TriangleMesh& mesh,
                                        const ComponentSelection& selection);

/// The component of every vertex, numbered 0, 1, ... by first vertex.
struct ComponentLabels {
    std::vector<std::int64_t> ofVertex;
    std::int64_t count = 0;
};
ComponentLabels labelComponents(const TriangleMesh& mesh);

}  // namespace adaptiso
