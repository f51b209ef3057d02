#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso::detail {

/// A triangle that is not in the prepared mesh, where another face of it went as well.
struct LostPair {
    Corners corners;
    std::uint32_t triangle;  ///< of the prepared mesh, one that shares a corner, or the first
};

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

    TriangleMesh mesh;                         ///< has the input's points; caps of holes come last
    std::vector<std::uint32_t> capOf;          ///< of each triangle from firstCap() on, its cap
    std::vector<std::uint8_t> capGoesInParts;  ///< of a cap: a part of it may be taken away alone
    std::vector<std::array<std::uint32_t, 3>> edgeOf;  ///< of a triangle, from corner i to i + 1
    std::vector<Edge> edges;
    std::vector<std::array<std::uint32_t, 2>> borders;  ///< edges in one triangle, caps aside
    std::vector<std::uint32_t> badVertices;             ///< that join triangles by themselves alone
    std::vector<std::array<std::uint32_t, 2>> crossingPairs;  ///< of triangles
    std::vector<std::uint32_t> undecided;  ///< triangles that lie near too many to be tested

    /// Where an open surface can't face one way, if all sheets are such.
    std::optional<Vec3> oneSidedMm;

    /// Where crossing triangles were cut: of each triangle the one before, if it is a part of that;
    /// else -1. Empty: none were.
    std::vector<std::int64_t> partOf;
    /// Then: what was dropped, within the solid, or off its border and outside of it.
    std::vector<MendedPlace> inner, outer;

    /// Triangles of walls that both went, and one of the others with a corner there.
    std::vector<LostPair> lostPairs;

    std::int64_t firstCap() const { return std::ssize(mesh.triangles) - std::ssize(capOf); }
    /// The mesh without caps.
    TriangleMesh given() const {
        TriangleMesh without = mesh;
        without.triangles.resize(firstCap());
        return without;
    }
};

/// \throws InvalidInput  there are too many for numbers of 32 bits
void requireCountable(const TriangleMesh& mesh);

/// \param statistics  gets what was found
/// \throws InvalidInput  as mend()
MendInput prepareInput(const TriangleMesh& mesh, MendStatistics& statistics);

/// The triangles by 32-bit numbers. \pre requireCountable()
std::vector<TriangleView::Triangle> inShort(const TriangleMesh& mesh);

/// Finds edges and vertices that are not sound. \param statistics  gets how many
/// \pre findEdges()
void judgeSurface(MendInput& input, MendStatistics& statistics);

/// Finds the edges of triangles, each with the number of its triangles in `edgeOf` order.
void findEdges(MendInput& input);

}  // namespace adaptiso::detail
