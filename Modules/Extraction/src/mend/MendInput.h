#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Mend.h"

namespace adaptiso::detail {

/// A mesh made ready to be mended: points of borders that lie at one place are one, triangles
/// without area and doubled ones are gone, triangles that hang together face the same way.
struct MendInput {
    /// An edge, a < b, and its triangles. The first runs from a to b, the second from b to a, where
    /// the surface is sound there.
    struct Edge {
        std::uint32_t a = 0, b = 0;
        std::array<std::int64_t, 2> triangles{-1, -1};
        bool isSound = false;
    };

    TriangleMesh mesh;                                 ///< has the input's points
    std::vector<std::array<std::uint32_t, 3>> edgeOf;  ///< of a triangle, from corner i to i + 1
    std::vector<Edge> edges;
    std::vector<std::uint32_t> badVertices;  ///< that join triangles by themselves alone
    std::vector<std::array<std::uint32_t, 2>> crossingPairs;  ///< of triangles
    std::vector<std::uint32_t> undecided;  ///< triangles that lie near too many to be tested
};

/// \param statistics  gets what was found
/// \throws InvalidInput  as mend()
MendInput prepareInput(const TriangleMesh& mesh, MendStatistics& statistics);

/// Finds the edges of triangles, each with the number of its triangles in `edgeOf` order.
void findEdges(MendInput& input);

}  // namespace adaptiso::detail
