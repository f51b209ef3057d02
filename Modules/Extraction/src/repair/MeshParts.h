#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso::detail {

/// A triangle mesh made ready to be simplified: cut open where it is no manifold, so that what is
/// left is one with borders.
struct MeshParts {
    using Triangle = std::array<std::uint32_t, 3>;

    /// Points seen from here: along axes where the mesh lies far off, so that little is lost in
    /// single precision. Taking it away and adding it again changes no bit of a point.
    Vec3 origin;
    std::vector<Vec3> points;  ///< those that triangles use
    std::vector<Triangle> triangles;
    /// Per point: Patch::kPlain, or for those that were cut apart Patch::kBorder + 1 + the
    /// number of the input's point in nonManifold. Empty: all plain.
    std::vector<std::uint32_t> marks;
    std::vector<std::uint8_t> isKept;        ///< of each point: it stays. Empty: none is
    std::vector<std::uint64_t> borderEdges;  ///< half-edges of open borders, not of cuts
    std::vector<VertexId> nonManifold;       ///< points of the input
    CrossingTriangles crossing;              ///< kept, undecided ones too
    std::vector<std::uint32_t>
        inputTriangle;  ///< of each triangle. Empty: its own number, or none crosses
    std::int64_t degenerate = 0, duplicate = 0;  ///< triangles that were dropped
    double movedMm = 0;  ///< no vertex of needles was farther from the one that it became

    TriangleView view() const { return {points, triangles}; }
};

/// \param keepsBorders  points of open borders stay
/// \param mayMoveMm     as far as movedMm may be
/// \throws InvalidInput when the mesh has no triangle with an area, an index out of range, a
///         coordinate that is not finite, or too many triangles
MeshParts takeApart(const TriangleMesh& mesh, bool keepsBorders, double mayMoveMm = 0);

}  // namespace adaptiso::detail
