#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

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
/// Cost: O(T log T) for several pieces, O(1) for one.
std::vector<std::int64_t> findInsideOutPieces(const TriangleMesh& mesh,
                                              const TopologyReport& topology);

}  // namespace adaptiso
