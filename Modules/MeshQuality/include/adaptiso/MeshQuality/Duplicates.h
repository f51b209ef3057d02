#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

struct DuplicateOptions {
    std::int64_t maxExamples = 5;  ///< numbers of each kind to name; all are counted
};

/// What a mesh has more than once at the very same place (0 and -0 are one).
struct DuplicateReport {
    std::int64_t vertexCount = 0;         ///< vertices at the place of one with a smaller number
    std::vector<VertexId> vertices;       ///< the first of them, ascending
    std::int64_t triangleCount = 0;       ///< triangles on the corners of one with a smaller number
    std::vector<std::int64_t> triangles;  ///< the first of them, ascending
};

/// Vertices with equal coordinates, and triangles whose corners lie at the same three places,
/// whatever their numbers and whichever way round. Only what is equal to the bit counts: vertices
/// that nearly coincide are short edges (measureShape). Points and triangles that are not finite
/// have no place; triangles with less than three places are left to checkTopology.
/// \pre triangles name points that are there, options.maxExamples >= 0 \throws InvalidInput
/// Cost: O(V log V + T log T), in parallel; 16 bytes a vertex and 32 a triangle of memory.
DuplicateReport findDuplicates(const TriangleMesh& mesh, const DuplicateOptions& options = {});

}  // namespace adaptiso
