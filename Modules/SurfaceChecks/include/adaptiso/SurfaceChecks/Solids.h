#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {

/// Where a solid of a file that holds several begins in the mesh. It ends where the next begins.
struct Solid {
    std::size_t firstPoint = 0;
    std::size_t firstTriangle = 0;
};

/// Gives every solid vertices of its own, if each is then closed: a file of organs whose walls
/// touch, or of parts to print. Patches of one surface, which are open each, stay joined.
/// \param mesh            triangles keep their numbers; vertices are renumbered by solid, unused
///                        ones last; normals are left out
/// \param firstTriangles  of each solid, ascending, the first 0 (MeshFile::solids)
/// \return those with triangles; empty, and `mesh` as it was, where there are not several, one is
///         open, or triangles name points that are not there
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

}  // namespace adaptiso
