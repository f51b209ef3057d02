#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {

/// Neighbourhood of a vertex or an edge that a change affects: the ring of vertices around it and
/// the triangles within. Then triangle i has the corners (new vertex, ring[i], ring[i + 1]). At an
/// open border the ring is a chain from border to border.
struct Star {
    static constexpr int kMost = 48;
    int count = 0;                              ///< of triangles
    std::array<std::uint32_t, kMost + 1> ring;  ///< a closed one ends with its first vertex again
    std::array<std::uint32_t, kMost> triangle;
    std::array<std::uint32_t, kMost> apex;  ///< the triangle's corner that is not on the ring
    std::array<std::uint32_t, 2> removed;   ///< triangles at the edge
    int removedCount = 0;
    std::array<int, 2> beside{};  ///< a triangle of the star beside each removed one
    bool isOpen = false;          ///< its vertex lies on an open border

    /// Vertices of the ring, each once.
    int ringCount() const { return isOpen ? count + 1 : count; }
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
    /// The half-edge of a triangle that starts at one of its corners.
    std::uint32_t leavingIn(std::uint32_t triangle, std::uint32_t corner) const {
        const auto& corners = patch_.triangles[triangle];
        return 3 * triangle + (corners[0] == corner ? 0 : corners[1] == corner ? 1 : 2);
    }

    /// All triangles around the vertex are own ones, and form one fan: a closed one, or at an open
    /// border one that ends there.
    bool isMovable(std::uint32_t vertex) const { return leaving_[vertex] != kNone; }
    /// A half-edge that starts at a movable vertex; on an open border the one along it.
    std::uint32_t leaving(std::uint32_t vertex) const { return leaving_[vertex]; }
    /// A movable vertex lies on an open border.
    bool isOnBorder(std::uint32_t vertex) const { return twin_[leaving_[vertex]] == kNone; }

    /// Calls f(half-edge) for those that start at a movable vertex, in their order around it.
    template <class F>
    void forEachLeaving(std::uint32_t vertex, const F& f) const {
        const std::uint32_t begin = leaving_[vertex];
        std::uint32_t h = begin;
        do {
            f(h);
            h = twin_[previous(h)];
        } while (h != begin && h != kNone);
    }

    /// The star of a movable vertex. False when it has more than Star::kMost triangles.
    bool starOf(std::uint32_t vertex, Star& star) const;

    /// The star of the edge that h runs along. \pre both ends are movable
    /// False when merging its ends would not leave a manifold (link condition) with the same
    /// borders, or has too many triangles.
    bool starOfEdge(std::uint32_t h, Star& star);

    /// Merges the ends of h into the one that it starts from.
    /// \pre starOfEdge(h, star) was true
    void collapse(std::uint32_t h, const Star& star);

private:
    bool addFan(std::uint32_t h, std::uint32_t last, Star& star) const;
    bool closedStarOf(std::uint32_t h, Star& star) const;
    bool openStarOf(std::uint32_t h, Star& star) const;
    bool ringIsSimple(const Star& star);
    void takeOut(std::uint32_t side);

    Patch& patch_;
    std::vector<std::uint32_t> twin_;
    std::vector<std::uint32_t> leaving_;  ///< at a border the one along it
    std::vector<std::uint32_t> stamp_;    ///< of vertices seen on the ring
    std::uint32_t now_ = 0;
};

}  // namespace adaptiso::detail
