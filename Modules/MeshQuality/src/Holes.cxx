#include "adaptiso/MeshQuality/Holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using Edge = std::array<VertexId, 2>;  ///< the smaller number first

/// Edges that lie in one triangle only, ascending.
std::vector<Edge> boundaryEdges(const TriangleMesh& mesh) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) {
            if (v < 0 || v >= count) {
                throw InvalidInput("findHoles: a triangle names vertex " + std::to_string(v) +
                                   ", there are " + std::to_string(count));
            }
        }
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        for (int n = 0; n < 3; ++n) {
            const VertexId a = t[n], b = t[(n + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<Edge> single;
    for (std::size_t n = 0; n < edges.size();) {
        std::size_t end = n + 1;
        while (end < edges.size() && edges[end] == edges[n]) ++end;
        if (end == n + 1) single.push_back(edges[n]);
        n = end;
    }
    return single;
}

/// Sets of vertices; a set goes by its smallest number.
class VertexSets {
public:
    VertexId find(VertexId v) {
        auto [place, isNew] = parents_.try_emplace(v, v);
        if (isNew || place->second == v) return v;
        return place->second = find(place->second);
    }
    void join(VertexId a, VertexId b) {
        a = find(a);
        b = find(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::map<VertexId, VertexId> parents_;
};

}  // namespace

std::vector<Hole> findHoles(const TriangleMesh& mesh) {
    const std::vector<Edge> edges = boundaryEdges(mesh);
    VertexSets sets;
    for (const Edge& edge : edges) sets.join(edge[0], edge[1]);
    std::map<VertexId, Hole> holes;  // by their smallest vertex
    for (const Edge& edge : edges) {
        const Vec3 &a = mesh.points[edge[0]], &b = mesh.points[edge[1]];
        const double lengthMm = norm(b - a);
        if (!std::isfinite(lengthMm)) continue;
        Hole& hole = holes[sets.find(edge[0])];
        ++hole.edges;
        hole.lengthMm += lengthMm;
        hole.middleMm += 0.5 * lengthMm * (a + b);
    }
    std::vector<Hole> result;
    for (auto& [vertex, hole] : holes) {
        hole.middleMm = hole.lengthMm > 0 ? 1 / hole.lengthMm * hole.middleMm : mesh.points[vertex];
        result.push_back(hole);
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Hole& a, const Hole& b) { return a.lengthMm > b.lengthMm; });
    return result;
}

}  // namespace adaptiso
