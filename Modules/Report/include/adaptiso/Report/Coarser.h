#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// A coarser surface, to be looked at: `mesh` itself where it has no more than `maxTriangles`, else
/// vertices that lie in one cell of a grid become one [Lindstrom2000]. No vertex moves out of its
/// cell; thin parts may join. Triangles with a corner that is not there or not finite are left out.
///
/// \param mesh  LPS mm; may be broken in any way
/// \return at most `maxTriangles`, without normals; the same for any number of threads
/// Cost: some passes over the mesh; 20 bytes for each of its vertices and 250 for each of the
/// result's.
TriangleMesh coarserMesh(const TriangleMesh& mesh, std::int64_t maxTriangles);

/// How many of `maxTriangles` each surface gets: the same for all, but none more than it has; what
/// small ones leave goes to the others.
std::vector<std::int64_t> shareTriangles(const std::vector<std::int64_t>& counts,
                                         std::int64_t maxTriangles);

}  // namespace adaptiso
