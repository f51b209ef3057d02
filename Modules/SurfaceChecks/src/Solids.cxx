#include "adaptiso/SurfaceChecks/Solids.h"

#include <algorithm>
#include <map>
#include <utility>

#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"

namespace adaptiso {

namespace {

std::size_t endOf(std::span<const Solid> solids, std::size_t number, std::size_t Solid::*first,
                  std::size_t end) {
    return number + 1 < solids.size() ? solids[number + 1].*first : end;
}

/// A triangle by its places, and whether they run in ascending order.
struct Placed {
    Triangle places;
    bool isTurned;
    std::size_t solid;
    std::int64_t number;
};

Placed placed(Triangle places, std::size_t solid, std::int64_t number) {
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    const bool isTurned = places[1] > places[2];
    if (isTurned) std::swap(places[1], places[2]);
    return {places, isTurned, solid, number};
}

constexpr std::int64_t kNone = -1;

std::ptrdiff_t solidOf(VertexId vertex, std::span<const Solid> solids) {
    const auto after = std::upper_bound(
        solids.begin(), solids.end(), static_cast<std::size_t>(vertex),
        [](std::size_t point, const Solid& solid) { return point < solid.firstPoint; });
    return after - solids.begin() - 1;
}

/// Numbers into topology.components; kNone: of a vertex that no triangle with three corners uses.
std::vector<std::int64_t> piecesOfVertices(const TriangleMesh& mesh,
                                           const TopologyReport& topology) {
    const std::vector<VertexId> roots = findComponentRoots(mesh);
    std::vector<std::int64_t> pieceOf(mesh.points.size(), kNone);
    for (std::size_t n = 0; n < topology.components.size(); ++n) {
        pieceOf[static_cast<std::size_t>(topology.components[n].firstVertex)] =
            static_cast<std::int64_t>(n);
    }
    for (std::size_t v = 0; v < roots.size(); ++v) {
        pieceOf[v] = pieceOf[static_cast<std::size_t>(roots[v])];
    }
    return pieceOf;
}

/// Of each piece a vertex at a place where no other solid has one, by number of piece. A place that
/// solids share is in neither. Pieces without such a vertex are left out.
std::vector<VertexId> ownVertices(const TriangleMesh& mesh, std::span<const Solid> solids,
                                  const std::vector<std::int64_t>& pieceOf) {
    TriangleMesh joined{mesh.points, {}, mesh.triangles};
    joinVertices(joined);
    constexpr std::ptrdiff_t kSeveral = -2;
    std::vector<std::ptrdiff_t> ownerOf(mesh.points.size(), kNone);
    const auto forEachCorner = [&](const auto& visit) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                visit(mesh.triangles[t][k],
                      ownerOf[static_cast<std::size_t>(joined.triangles[t][k])]);
            }
        }
    };
    forEachCorner([&](VertexId v, std::ptrdiff_t& owner) {
        const std::ptrdiff_t solid = solidOf(v, solids);
        owner = owner == kNone || owner == solid ? solid : kSeveral;
    });
    std::map<std::int64_t, VertexId> vertexOf;  // of each piece
    forEachCorner([&](VertexId v, std::ptrdiff_t owner) {
        const std::int64_t piece = pieceOf[static_cast<std::size_t>(v)];
        if (piece != kNone && owner != kSeveral) vertexOf.emplace(piece, v);
    });
    std::vector<VertexId> vertices;
    for (const auto& [piece, v] : vertexOf) vertices.push_back(v);
    return vertices;
}

}  // namespace

std::vector<Solid> separateSolids(TriangleMesh& mesh,
                                  std::span<const std::int64_t> firstTriangles) {
    const std::int64_t all = std::ssize(mesh.triangles);
    if (firstTriangles.size() < 2 || firstTriangles.front() != 0 || firstTriangles.back() > all ||
        !std::ranges::is_sorted(firstTriangles)) {
        return {};
    }
    const std::int64_t count = std::ssize(mesh.points);
    std::vector<VertexId> numbers(mesh.points.size(), kNone);
    TriangleMesh apart;
    std::vector<Solid> solids;
    for (std::size_t n = 0; n < firstTriangles.size(); ++n) {
        const std::int64_t begin = firstTriangles[n];
        const std::int64_t end = n + 1 < firstTriangles.size() ? firstTriangles[n + 1] : all;
        if (begin == end) continue;
        solids.push_back({apart.points.size(), static_cast<std::size_t>(begin)});
        const std::span<const Triangle> triangles(mesh.triangles.data() + begin,
                                                  static_cast<std::size_t>(end - begin));
        // in their order, so that vertices of solids that are apart keep their numbers
        std::vector<VertexId> used;
        for (const Triangle& triangle : triangles) {
            for (const VertexId v : triangle) {
                if (v < 0 || v >= count) return {};
                used.push_back(v);
            }
        }
        std::ranges::sort(used);
        used.erase(std::unique(used.begin(), used.end()), used.end());
        for (const VertexId v : used) {
            numbers[static_cast<std::size_t>(v)] = std::ssize(apart.points);
            apart.points.push_back(mesh.points[static_cast<std::size_t>(v)]);
        }
        for (Triangle triangle : triangles) {
            for (VertexId& v : triangle) v = numbers[static_cast<std::size_t>(v)];
            apart.triangles.push_back(triangle);
        }
    }
    if (solids.size() < 2 || !checkTopology(apart, {.maxExamplesPerDefect = 0}).isClosed()) {
        return {};
    }
    for (std::size_t v = 0; v < numbers.size(); ++v) {
        if (numbers[v] == kNone) apart.points.push_back(mesh.points[v]);
    }
    mesh = std::move(apart);
    return solids;
}

TriangleMesh solidAt(const TriangleMesh& mesh, std::span<const Solid> solids, std::size_t number) {
    const Solid& solid = solids[number];
    const std::size_t pointsEnd = endOf(solids, number, &Solid::firstPoint, mesh.points.size()),
                      trianglesEnd =
                          endOf(solids, number, &Solid::firstTriangle, mesh.triangles.size());
    TriangleMesh alone;
    alone.points.assign(mesh.points.begin() + static_cast<std::ptrdiff_t>(solid.firstPoint),
                        mesh.points.begin() + static_cast<std::ptrdiff_t>(pointsEnd));
    for (std::size_t t = solid.firstTriangle; t < trianglesEnd; ++t) {
        Triangle triangle = mesh.triangles[t];
        for (VertexId& vertex : triangle) vertex -= static_cast<VertexId>(solid.firstPoint);
        alone.triangles.push_back(triangle);
    }
    return alone;
}

SharedWalls findSharedWalls(const TriangleMesh& mesh, std::span<const Solid> solids,
                            const SelfIntersectionOptions& options) {
    TriangleMesh joined{mesh.points, {}, mesh.triangles};
    joinVertices(joined);
    std::vector<Placed> triangles;
    triangles.reserve(joined.triangles.size());
    for (std::size_t n = 0; n < solids.size(); ++n) {
        const std::size_t end = endOf(solids, n, &Solid::firstTriangle, joined.triangles.size());
        for (std::size_t t = solids[n].firstTriangle; t < end; ++t) {
            triangles.push_back(placed(joined.triangles[t], n, static_cast<std::int64_t>(t)));
        }
    }
    std::ranges::sort(triangles, {}, [](const Placed& t) { return std::pair(t.places, t.number); });

    std::vector<std::uint8_t> isTwin(joined.triangles.size(), 0);
    for (std::size_t i = 1; i < triangles.size(); ++i) {
        const Placed &a = triangles[i - 1], &b = triangles[i];
        if (a.places != b.places || a.solid == b.solid || a.isTurned == b.isTurned) continue;
        if (isTwin[static_cast<std::size_t>(a.number)] != 0) continue;  // a third lies there
        isTwin[static_cast<std::size_t>(b.number)] = 1;
    }

    SharedWalls walls;
    std::vector<std::int64_t> numbers;
    joined.triangles.clear();
    for (std::size_t t = 0; t < isTwin.size(); ++t) {
        if (isTwin[t] != 0) {
            ++walls.triangleCount;
            continue;
        }
        numbers.push_back(static_cast<std::int64_t>(t));
        joined.triangles.push_back(mesh.triangles[t]);
    }
    walls.intersections = findSelfIntersections(joined, options);
    for (TrianglePair& pair : walls.intersections.pairs) {
        for (std::int64_t& triangle : pair) triangle = numbers[static_cast<std::size_t>(triangle)];
    }
    return walls;
}

std::vector<std::int64_t> findPiecesWithin(const TriangleMesh& mesh, const TopologyReport& topology,
                                           std::span<const Solid> solids) {
    const std::vector<std::int64_t> pieceOf = piecesOfVertices(mesh, topology);
    std::vector<std::int64_t> pieces;
    std::vector<Vec3> points;
    for (const VertexId v : ownVertices(mesh, solids, pieceOf)) {
        pieces.push_back(pieceOf[static_cast<std::size_t>(v)]);
        points.push_back(mesh.points[static_cast<std::size_t>(v)]);
    }
    const auto solidOfPiece = [&](std::size_t piece) {
        return solidOf(topology.components[piece].firstVertex, solids);
    };
    const auto around =
        findPiecesAround(mesh, pieceOf, points, [&](std::size_t n, std::size_t piece) {
            return solidOfPiece(piece) != solidOfPiece(static_cast<std::size_t>(pieces[n]));
        });
    std::vector<std::int64_t> within;
    for (std::size_t n = 0; n < pieces.size(); ++n) {
        std::map<std::ptrdiff_t, int> walls;  // of each solid, between the point and far away
        for (const std::uint32_t piece : around[n]) ++walls[solidOfPiece(piece)];
        if (std::ranges::any_of(walls, [](const auto& each) { return each.second % 2 == 1; })) {
            within.push_back(pieces[n]);
        }
    }
    return within;
}

}  // namespace adaptiso
