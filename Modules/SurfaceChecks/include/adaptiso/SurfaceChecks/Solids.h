#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// Where a solid of a file that holds several begins in the mesh. It ends where the next begins.
struct Solid {
    std::size_t firstPoint = 0;
    std::size_t firstTriangle = 0;
};

/// Gives every solid vertices of its own, if each is then closed: a file of organs whose walls
/// touch, or of parts to print. Patches of one surface, which are open each, stay joined.
/// \param mesh            triangles keep their numbers; vertices are numbered by solid, then in
/// their
///                        order, unused ones last; normals are left out
/// \param firstTriangles  of each solid (MeshFile::solids)
/// \return those with triangles; empty, and `mesh` as it was, where there are not several, one is
///         open, triangles name points that are not there, or numbers do not ascend from 0
std::vector<Solid> separateSolids(TriangleMesh& mesh, std::span<const std::int64_t> firstTriangles);

/// One of them as a mesh of its own. \param number  into `solids`
TriangleMesh solidAt(const TriangleMesh& mesh, std::span<const Solid> solids, std::size_t number);

/// Walls that two solids share: a triangle of one lies on one of the other, wound the other way.
struct SharedWalls {
    std::int64_t triangleCount = 0;   ///< each wall's counted once
    SelfIntersections intersections;  ///< of all triangles, of two in a shared wall the first
};

/// \pre triangles name points that are there; solids as separateSolids() gives them
/// Cost: that of findSelfIntersections(), and O(T log T)
SharedWalls findSharedWalls(const TriangleMesh& mesh, std::span<const Solid> solids,
                            const SelfIntersectionOptions& options);

/// Pieces, as numbers into topology.components, that lie in the material of another solid: some
/// vertex, at whose place no other solid has one, has an odd number of that solid's pieces round
/// it. A solid that fills another's cavity does not. \param topology  checkTopology(mesh)
/// \pre topology.isWatertight(), coordinates are finite
/// Cost: O(T log T), and a ray for each piece; 64 bytes a vertex
std::vector<std::int64_t> findPiecesWithin(const TriangleMesh& mesh, const TopologyReport& topology,
                                           std::span<const Solid> solids);

}  // namespace adaptiso
