#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// For each point the closed pieces around it, ascending: those that a ray from it passes an odd
/// number of times, decided exactly.
/// \param pieceOf  of each vertex
/// \param matters  of a point's number and a piece's: whether to look at it; called in parallel
/// \pre coordinates are finite, triangles name points that are there
/// Cost: O(T) and a ray for each point, which looks at the triangles beside it; in parallel.
std::vector<std::vector<std::uint32_t>> findPiecesAround(
    const TriangleMesh& mesh, const std::vector<std::int64_t>& pieceOf,
    const std::vector<Vec3>& points, const std::function<bool(std::size_t, std::size_t)>& matters);

/// The pieces of a closed, oriented surface whose triangles are the wrong way round, as numbers
/// into topology.components.
///
/// A piece that lies in an even number of others bounds material from outside: its triangles are to
/// be counter-clockwise seen from outside it. One that lies in an odd number is the wall of a
/// cavity and is to be the other way round. A piece lies in another if one of its
/// vertices does and no two of their triangles cross (trianglesCross): of two that cross neither
/// lies in the other.
/// \param topology  checkTopology(mesh) \pre  topology.isWatertight(), finite coordinates,
/// triangles name points that are there
///       \throws InvalidInput otherwise
/// \return  empty where thousands of pieces lie in each other, or cross so often that the budget of
///          findCrossingPairs() ends
/// Cost: O(T log T) for several pieces, O(1) for one; 4096 tests of a ray a triangle at most.
std::optional<std::vector<std::int64_t>> findInsideOutPieces(const TriangleMesh& mesh,
                                                             const TopologyReport& topology);

struct InsideOutPieces {
    std::int64_t count = 0;
    std::int64_t flat = 0;                ///< pieces of hardly any volume, which have no inside
    std::vector<std::int64_t> triangles;  ///< of those inside out, ascending
};

/// The same for a surface whose pieces do not cross: counts those inside out.
/// \param isLeftOut  of each point: the piece that it is of is neither judged nor around others,
///                   such as an open one. Empty: none is
/// \pre  the other pieces are closed, oriented and finite, triangles name points that are there
/// Cost: O(T) and a ray for each piece, which looks at the triangles beside it; in parallel.
InsideOutPieces findInsideOutPieces(const TriangleView& surface,
                                    const std::vector<std::uint8_t>& isLeftOut);

}  // namespace adaptiso
