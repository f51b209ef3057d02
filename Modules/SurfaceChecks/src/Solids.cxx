#include "adaptiso/SurfaceChecks/Solids.h"

#include <algorithm>
#include <array>
#include <utility>

#include "adaptiso/MeshQuality/Topology.h"

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

}  // namespace

std::vector<Solid> separateSolids(TriangleMesh& mesh,
                                  std::span<const std::int64_t> firstTriangles) {
    if (firstTriangles.size() < 2) return {};
    const std::size_t count = mesh.points.size();
    constexpr VertexId kNone = -1;
    std::vector<VertexId> numbers(count, kNone);
    std::vector<std::size_t> usedBy(count, firstTriangles.size());
    TriangleMesh apart;
    std::vector<Solid> solids;
    for (std::size_t n = 0; n < firstTriangles.size(); ++n) {
        const auto begin = static_cast<std::size_t>(firstTriangles[n]);
        const std::size_t end = n + 1 < firstTriangles.size()
                                    ? static_cast<std::size_t>(firstTriangles[n + 1])
                                    : mesh.triangles.size();
        if (begin == end) continue;
        solids.push_back({apart.points.size(), begin});
        for (std::size_t t = begin; t < end; ++t) {
            Triangle triangle = mesh.triangles[t];
            for (VertexId& vertex : triangle) {
                if (vertex < 0 || static_cast<std::size_t>(vertex) >= count) return {};
                const auto v = static_cast<std::size_t>(vertex);
                if (usedBy[v] != n) {
                    usedBy[v] = n;
                    numbers[v] = static_cast<VertexId>(apart.points.size());
                    apart.points.push_back(mesh.points[v]);
                }
                vertex = numbers[v];
            }
            apart.triangles.push_back(triangle);
        }
    }
    if (solids.size() < 2 || !checkTopology(apart, {.maxExamplesPerDefect = 0}).isClosed())
        return {};
    for (std::size_t v = 0; v < count; ++v) {
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

}  // namespace adaptiso
