#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/SurfaceProof/SurfaceMap.h"
#include "adaptive/full/MeshParts.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// Maps triangles of a mesh, one by one, to the simplified surface.
class PieceMap {
public:
    using Map = SurfaceMap<SurfaceState::Number>;

    /// Keeps references to all it is given.
    /// \param enoughMm  cuts of edges need not be nearer to their images
    PieceMap(const MeshParts& parts, const WalkableSurface<std::uint32_t>& fine,
             const SimplifiedSurface& surface, const WalkableSurface<SurfaceState::Number>& onto,
             double enoughMm)
        : parts_(parts), fine_(fine), surface_(surface), map_(onto, enoughMm * enoughMm) {}

    /// \return false when the triangle could not be mapped within the distance
    bool map(std::uint32_t t, double squaredDistance) {
        std::array<const Map::Vertex*, 3> corners{};
        std::array<Map::Side, 3> sides{};
        map_.clear();
        for (int i = 0; i < 3; ++i) {
            vertex_[i] = vertexAt(parts_.triangles[t][i]);
            corners[i] = &vertex_[i];
        }
        for (std::uint32_t i = 0; i < 3; ++i) {
            const bool isForward = 3 * t + i < fine_.twin(3 * t + i);
            const Map::Vertex &a = vertex_[i], &b = vertex_[(i + 1) % 3];
            sides[i] = {nullptr, isForward};
            if (a.imageTriangle == b.imageTriangle) continue;
            way_[i] = isForward ? map_.wayAlong(a, b) : map_.wayAlong(b, a);
            sides[i].way = &way_[i];
        }
        return map_.map(corners, sides, squaredDistance);
    }
    std::span<const Map::Part> parts() const { return map_.parts(); }

    /// Calls f(triangle) for those of the simplified surface that the image of an edge passes.
    template <class F>
    void forEachAlong(std::uint32_t halfEdge, const F& f) {
        const std::uint32_t h = std::min(halfEdge, fine_.twin(halfEdge));
        const auto& v = parts_.triangles[h / 3];
        const Map::Vertex a = vertexAt(v[h % 3]), b = vertexAt(v[(h + 1) % 3]);
        f(a.imageTriangle);
        if (a.imageTriangle == b.imageTriangle) return;
        map_.clear();
        map_.forEachAlong(map_.wayAlong(a, b), f);
    }

private:
    Map::Vertex vertexAt(std::uint32_t v) const {
        return map_.vertexAt(parts_.points[v], surface_.sampleTriangle[v]);
    }

    const MeshParts& parts_;
    const WalkableSurface<std::uint32_t>& fine_;
    const SimplifiedSurface& surface_;
    Map map_;
    std::array<Map::Vertex, 3> vertex_;
    std::array<Map::Way, 3> way_;
};

}  // namespace adaptiso::detail
