#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Defects of a mesh as a surface.
enum class TopologyDefect {
    BoundaryEdge,        ///< an edge in one triangle
    NonManifoldEdge,     ///< an edge in more than two
    InconsistentEdge,    ///< an edge whose two triangles run along it the same way
    NonManifoldVertex,   ///< a vertex whose triangles are not one fan (closed or open)
    DegenerateTriangle,  ///< no area: see checkTopology
    DuplicateTriangle,   ///< the same three vertices as an earlier triangle, whichever way round
    UnusedVertex,        ///< a vertex in no triangle
    NonFiniteVertex,     ///< a coordinate that is NaN or infinite
    IndexOutOfRange      ///< a triangle with an index that names no point
};
inline constexpr int kTopologyDefectCount = 9;

/// "boundary edge", "non-manifold vertex", ...
std::string_view toString(TopologyDefect defect);

/// Place of a defect.
struct TopologyExample {
    TopologyDefect defect;
    std::int64_t triangle = -1;                    ///< triangle number; -1: not of a triangle
    std::array<VertexId, 3> vertices{-1, -1, -1};  ///< its vertices (1, 2 or 3); -1: no more
    Vec3 pointMm;                                  ///< middle of them, mm
};

/// A piece of surface: triangles that hang together by shared vertices.
struct SurfaceComponent {
    std::int64_t vertices = 0;
    std::int64_t edges = 0;
    std::int64_t triangles = 0;
    std::int64_t boundaryEdges = 0;
    bool isManifold = true;  ///< no non-manifold edge or vertex
    bool isOriented = true;  ///< no edge of inconsistent orientation
    double areaMm2 = 0;
    double signedVolumeMm3 = 0;  ///< > 0: outward. Says nothing of a piece that is not closed
    VertexId firstVertex = 0;    ///< its smallest vertex number

    std::int64_t eulerCharacteristic() const { return vertices - edges + triangles; }
    bool isClosed() const { return boundaryEdges == 0; }
    /// Counter-clockwise seen from outside the piece. The wall of a cavity is rightly inward.
    bool isOutward() const { return signedVolumeMm3 > 0; }
    /// Handles. \return none unless the piece is a closed, oriented 2-manifold
    std::optional<std::int64_t> genus() const;
};

/// The facts about a mesh as a surface. Findings are data: nothing here is an exception.
struct TopologyReport {
    std::int64_t vertices = 0;
    std::int64_t edges = 0;
    std::int64_t triangles = 0;
    std::array<std::int64_t, kTopologyDefectCount> defects{};  ///< by TopologyDefect
    std::vector<SurfaceComponent> components;                  ///< by smallest vertex number
    std::vector<TopologyExample> examples;                     ///< the first few of each defect

    std::int64_t count(TopologyDefect defect) const {
        return defects[static_cast<std::size_t>(defect)];
    }
    /// Sum over the components.
    std::int64_t eulerCharacteristic() const {
        std::int64_t sum = 0;
        for (const SurfaceComponent& component : components) sum += component.eulerCharacteristic();
        return sum;
    }
    /// No edge has a free side. (True of an empty mesh, as is all of the following.)
    bool isClosed() const { return count(TopologyDefect::BoundaryEdge) == 0; }
    /// Every edge lies in at most two triangles, the triangles of every vertex are one fan.
    bool isManifold() const {
        return count(TopologyDefect::NonManifoldEdge) == 0 &&
               count(TopologyDefect::NonManifoldVertex) == 0;
    }
    bool isOriented() const { return count(TopologyDefect::InconsistentEdge) == 0; }
    /// Closed, manifold and oriented, and every index names a point.
    bool isWatertight() const {
        return isClosed() && isManifold() && isOriented() &&
               count(TopologyDefect::IndexOutOfRange) == 0;
    }
    /// True without any defect.
    bool isSound() const;
    /// Genus of all pieces together. \return none when a piece has none
    std::optional<std::int64_t> genus() const;
};

struct TopologyOptions {
    int maxExamplesPerDefect = 5;
};

/// Checks `mesh` as a surface: closed, manifold, oriented, number of pieces, genus.
///
/// A triangle is degenerate when it names a vertex twice, or when its smallest altitude is at most
/// 1e-9 of its longest edge. That is far above what rounding makes of a true zero (1e-12 for edges
/// of 0.1 mm at 300 mm from the origin) and far below the slivers of a sensible surface; a ratio
/// judges a mesh in metres as one in millimetres. Triangles that name a vertex twice or a point
/// that isn't there take no part in edges, fans and components; those merely flat do. Triangles
/// with a non-finite corner are not judged for area, and add none.
///
/// Cost: O(T log d), d the largest number of triangles at a vertex; 24 bytes a triangle and 40 a
/// vertex of memory. The same mesh gives the same report, whatever the number of threads.
TopologyReport checkTopology(const TriangleMesh& mesh, const TopologyOptions& options = {});

/// A triangle has no area, as checkTopology judges it.
/// \pre its indices name points of `mesh`
bool isDegenerate(const TriangleMesh& mesh, const Triangle& triangle);

/// For every vertex, the smallest vertex number of the piece that it belongs to (as
/// checkTopology's SurfaceComponent::firstVertex); its own when no triangle uses it.
std::vector<VertexId> findComponentRoots(const TriangleMesh& mesh);

struct DuplicateOptions {
    std::int64_t maxExamples = 5;  ///< numbers of each kind to name; all are counted
};

/// Vertices and triangles that coincide exactly with others (0 and -0 are equal).
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

/// Triangles name the first vertex at each place, so that parts which only touch there are one.
/// Vertices keep their numbers; those that were named and are no longer stay, unused.
/// \return how many these are   \pre triangles name points that are there \throws InvalidInput
std::int64_t joinVertices(TriangleMesh& mesh);

/// A stretch of border: edges that lie in one triangle only and hang together by their corners.
struct Hole {
    std::int64_t edges = 0;
    double lengthMm = 0;  ///< of all of them
    double spanMm = 0;    ///< by its Reach
    Vec3 middleMm;        ///< mean of the edges' middles, weighted by their length
};

/// The holes of a surface, the longest border first, of equals the one with the smaller vertex
/// number. The rim of an open sheet counts as a hole too.
///
/// Triangles that name a vertex twice have no edges here, as checkTopology has it; edges with a
/// corner that is not finite are left out.
/// \pre triangles name points that are there \throws InvalidInput otherwise
/// Cost: O(T log T); 48 bytes a triangle of memory.
std::vector<Hole> findHoles(const TriangleMesh& mesh);

}  // namespace adaptiso
