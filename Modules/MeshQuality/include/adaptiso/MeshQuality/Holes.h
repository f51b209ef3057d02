#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// A stretch of border: edges that lie in one triangle only and hang together by their corners.
struct Hole {
    std::int64_t edges = 0;
    double lengthMm = 0;  ///< of all of them
    Vec3 middleMm;        ///< mean of the edges' middles, weighted by their length
};

/// The holes of a surface, the longest border first, of equals the one with the smaller vertex
/// number. The rim of an open sheet is one too: what is missing can't be told from what never was.
///
/// Triangles that name a vertex twice have no edges here, as checkTopology has it; edges with a
/// corner that is not finite are left out.
/// \pre triangles name points that are there \throws InvalidInput otherwise
/// Cost: O(T log T); 48 bytes a triangle of memory.
std::vector<Hole> findHoles(const TriangleMesh& mesh);

}  // namespace adaptiso
