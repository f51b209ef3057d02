#include "Handles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>
#include <vector>

#include "EditMesh.h"

namespace adaptiso {
namespace {

using HalfEdge = EditMesh::HalfEdge;

/// Shortest paths along edges from a root.
struct PathTree {
    std::vector<double> lengthMm;
    std::vector<HalfEdge> arriving;  ///< half-edge that the path to a vertex ends with; -1: root
};

PathTree growPaths(const EditMesh& mesh, VertexId root) {
    PathTree tree{std::vector<double>(mesh.vertexSlots(), std::numeric_limits<double>::infinity()),
                  std::vector<HalfEdge>(mesh.vertexSlots(), -1)};
    using Entry = std::pair<double, VertexId>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    tree.lengthMm[root] = 0;
    queue.emplace(0, root);
    while (!queue.empty()) {
        const double length = queue.top().first;
        const VertexId v = queue.top().second;
        queue.pop();
        if (length > tree.lengthMm[v]) continue;
        mesh.forEachOut(v, [&](HalfEdge h) {
            const double longer = length + std::sqrt(mesh.squaredLength(h));
            if (longer >= tree.lengthMm[mesh.to(h)]) return;
            tree.lengthMm[mesh.to(h)] = longer;
            tree.arriving[mesh.to(h)] = h;
            queue.emplace(longer, mesh.to(h));
        });
    }
    return tree;
}

double loopLength(const EditMesh& mesh, const PathTree& paths, HalfEdge h) {
    return paths.lengthMm[mesh.from(h)] + paths.lengthMm[mesh.to(h)] +
           std::sqrt(mesh.squaredLength(h));
}

/// Edges that are neither on a path nor crossed by the tree over the triangles that crosses the
/// edges of the longest loops: two a handle, and no shorter ones through the root will do.
std::vector<HalfEdge> edgesOfHandles(const EditMesh& mesh, const PathTree& paths) {
    std::vector<std::pair<double, HalfEdge>> edges;
    for (HalfEdge h = 0; h < mesh.halfEdgeSlots(); ++h) {
        const bool isOnPath =
            paths.arriving[mesh.to(h)] == h || paths.arriving[mesh.from(h)] == mesh.twin(h);
        if (mesh.isFirst(h) && !isOnPath) edges.emplace_back(-loopLength(mesh, paths, h), h);
    }
    std::sort(edges.begin(), edges.end());
    std::vector<std::int64_t> parent(mesh.halfEdgeSlots() / 3);
    std::iota(parent.begin(), parent.end(), std::int64_t{0});
    const auto root = [&](std::int64_t t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    std::vector<HalfEdge> left;
    for (const auto& [length, h] : edges) {
        const std::int64_t a = root(h / 3), b = root(mesh.twin(h) / 3);
        if (a == b) {
            left.push_back(h);
        } else {
            parent[a] = b;
        }
    }
    return left;
}

/// The two paths to the ends of `edge`, without the part that they share.
Vec3 loopCentre(const EditMesh& mesh, const PathTree& paths, HalfEdge edge) {
    std::vector<bool> isOnFirst(mesh.vertexSlots());
    const auto previous = [&](VertexId v) {
        return paths.arriving[v] < 0 ? VertexId{-1} : mesh.from(paths.arriving[v]);
    };
    for (VertexId v = mesh.from(edge); v >= 0; v = previous(v)) isOnFirst[v] = true;
    Vec3 sum;
    double count = 0;
    const auto add = [&](VertexId v) {
        sum += mesh.point(v);
        ++count;
    };
    VertexId meeting = mesh.to(edge);
    for (; !isOnFirst[meeting]; meeting = previous(meeting)) add(meeting);
    for (VertexId v = mesh.from(edge); v != meeting; v = previous(v)) add(v);
    add(meeting);
    return 1 / count * sum;
}

}  // namespace

HandleLoop findHandleLoop(const TriangleMesh& surface) {
    constexpr int kMaxRoots = 6;
    const EditMesh mesh(surface);
    HandleLoop best{std::numeric_limits<double>::infinity(), {}};
    VertexId root = mesh.from(0);
    for (int round = 0; round < kMaxRoots; ++round) {
        const PathTree paths = growPaths(mesh, root);
        double shortest = best.lengthMm;
        HalfEdge edge = -1;
        for (const HalfEdge h : edgesOfHandles(mesh, paths)) {
            if (loopLength(mesh, paths, h) >= shortest) continue;
            shortest = loopLength(mesh, paths, h);
            edge = h;
        }
        if (edge < 0) break;
        best = {shortest, loopCentre(mesh, paths, edge)};
        root = mesh.from(edge);
    }
    return best;
}

}  // namespace adaptiso
