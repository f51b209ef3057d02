#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptiso/SurfaceProof/SurfaceMap.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// Maps a piece of the full surface, triangle by triangle, to the simplified one. Knows the images
/// of vertices and edges that it has looked at: a vertex is met six times, an edge twice.
class PieceMap {
public:
    using Number = SurfaceState::Number;
    using Map = SurfaceMap<Number>;

    /// Keeps references to all it is given.
    /// \param assigned  the triangle of `onto` that each vertex of `fine` is assigned to
    /// \param enoughMm  cuts of edges need not be nearer to their images
    PieceMap(const WalkableSurface<std::uint32_t>& fine, std::span<const Number> assigned,
             const WalkableSurface<Number>& onto, double enoughMm)
        : fine_(fine),
          assigned_(assigned),
          map_(onto, enoughMm * enoughMm),
          vertices_(kVertices, {kNone, {}}) {}

    /// The piece is made up of these triangles.
    void beginPiece(std::uint32_t first, std::uint32_t count) {
        firstHalfEdge_ = 3 * first;
        map_.clear();
        ways_.assign(std::size_t{3} * count, {});
    }

    /// \return false when the triangle could not be mapped within the distance
    bool map(std::uint32_t t, double squaredDistance) {
        std::array<const Map::Vertex*, 3> corners{};
        std::array<Map::Side, 3> sides{};
        for (int i = 0; i < 3; ++i) {
            vertex_[i] = vertexAt(fine_.verticesOf(t)[i]);
            corners[i] = &vertex_[i];
        }
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t h = 3 * t + i, edge = std::min(h, fine_.twin(h));
            const Map::Vertex &a = vertex_[i], &b = vertex_[(i + 1) % 3];
            sides[i] = {nullptr, h == edge};
            if (a.imageTriangle == b.imageTriangle) continue;
            const bool isOwn = edge >= firstHalfEdge_;  // as all edges but those of pieces before
            Map::Way& way = isOwn ? ways_[edge - firstHalfEdge_] : way_[i];
            if (!isOwn || !way.isKnown())
                way = h == edge ? map_.wayAlong(a, b) : map_.wayAlong(b, a);
            sides[i].way = &way;
        }
        return map_.map(corners, sides, squaredDistance);
    }
    std::span<const Map::Part> parts() const { return map_.parts(); }

    /// Calls f(triangle) for those of the simplified surface that the image of an edge passes.
    template <class F>
    void forEachAlong(std::uint32_t halfEdge, const F& f) {
        const std::uint32_t h = std::min(halfEdge, fine_.twin(halfEdge));
        const auto& v = fine_.verticesOf(h / 3);
        const Map::Vertex a = vertexAt(v[h % 3]), b = vertexAt(v[(h + 1) % 3]);
        f(a.imageTriangle);
        if (a.imageTriangle == b.imageTriangle) return;
        map_.clear();
        map_.forEachAlong(map_.wayAlong(a, b), f);
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF, kVertices = 1 << 12;

    struct KnownVertex {
        std::uint32_t number;
        Map::Vertex vertex;
    };
    /// Each is kept until another one needs its place.
    Map::Vertex vertexAt(std::uint32_t v) {
        KnownVertex& known = vertices_[v % kVertices];
        if (known.number != v) known = {v, map_.vertexAt(fine_.point(v), assigned_[v])};
        return known.vertex;
    }

    const WalkableSurface<std::uint32_t>& fine_;
    std::span<const Number> assigned_;
    Map map_;
    std::vector<KnownVertex> vertices_;
    std::uint32_t firstHalfEdge_ = 0;
    std::vector<Map::Way> ways_;  ///< of the piece's edges, by the first half-edge
    std::array<Map::Vertex, 3> vertex_;
    std::array<Map::Way, 3> way_;
};

}  // namespace adaptiso::detail
