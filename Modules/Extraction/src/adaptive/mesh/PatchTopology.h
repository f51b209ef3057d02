#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {

/// What would change around a vertex or an edge: the closed ring of vertices around it and the
/// triangles within. After the change triangle i has the corners (new vertex, ring[i],
/// ring[i + 1]).
struct Star {
    static constexpr int kMost = 48;
    int count = 0;
    std::array<std::uint32_t, kMost> ring;
    std::array<std::uint32_t, kMost> triangle;
    std::array<std::uint32_t, kMost> apex;  ///< the triangle's corner that is not on the ring
    std::array<std::uint32_t, 2> removed;   ///< triangles at the edge
    int removedCount = 0;
    int secondWedge = 0;  ///< wedge beside removed[1]; removed[0] lies beside wedge 0
};

/// Half-edges of a patch's own triangles. Half-edge 3 t + c runs from corner c of triangle t to
/// the next corner.
class PatchTopology {
public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    explicit PatchTopology(Patch& patch);

    static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
    std::uint32_t from(std::uint32_t h) const { return patch_.triangles[h / 3][h % 3]; }
    std::uint32_t to(std::uint32_t h) const { return from(next(h)); }
    std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }

    /// All triangles around the vertex are own ones, and form one closed fan.
    bool isMovable(std::uint32_t vertex) const { return leaving_[vertex] != kNone; }
    /// A half-edge that starts at a movable vertex.
    std::uint32_t leaving(std::uint32_t vertex) const { return leaving_[vertex]; }

    /// The star of a movable vertex. False when it has more than Star::kMost triangles.
    bool starOf(std::uint32_t vertex, Star& star) const;

    /// The star of the edge that h runs along. \pre both ends are movable
    /// False when merging its ends would not leave a manifold (link condition), or has too many
    /// triangles.
    bool starOfEdge(std::uint32_t h, Star& star);

    /// Merges the ends of h into the one that it starts from.
    /// \pre starOfEdge(h, star) was true
    void collapse(std::uint32_t h, const Star& star);

private:
    bool ringIsSimple(const Star& star);

    Patch& patch_;
    std::vector<std::uint32_t> twin_;
    std::vector<std::uint32_t> leaving_;
    std::vector<std::uint32_t> stamp_;  ///< of vertices seen on the ring
    std::uint32_t now_ = 0;
};

}  // namespace adaptiso::detail
