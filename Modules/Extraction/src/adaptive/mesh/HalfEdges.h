#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptive/mesh/OrderedBuckets.h"

namespace adaptiso::detail {

/// The half-edges of triangles by the vertex that they start from. Half-edge 3 t + c runs from
/// corner c of triangle t to the next corner.
template <class Index>
class HalfEdges {
public:
    static constexpr Index kNone = std::numeric_limits<Index>::max();

    /// Keeps a reference to the triangles.
    void assign(std::size_t points, std::span<const std::array<Index, 3>> triangles) {
        triangles_ = triangles;
        leaving_.assign(points, triangles.size(), [&](std::size_t t, const auto& put) {
            for (std::size_t c = 0; c < 3; ++c) {
                put(triangles[t][c], static_cast<Index>(3 * t + c));
            }
        });
    }

    /// In ascending order.
    std::span<const Index> from(Index vertex) const { return leaving_.of(vertex); }
    /// The vertex that a half-edge runs to.
    Index to(Index halfEdge) const { return triangles_[halfEdge / 3][(halfEdge + 1) % 3]; }

    /// The opposite of each half-edge, or kNone. Where several run along an edge they are matched
    /// in ascending order. \param triangles  as given to assign()
    void match(std::span<const std::array<Index, 3>> triangles, std::vector<Index>& twin) const {
        constexpr std::size_t kMany = 1 << 15;  // below, threads cost more than they save
        twin.assign(3 * triangles.size(), kNone);
        if (triangles.size() < kMany) {
            forEachOf(0, triangles.size(), [&](Index h, Index a, Index b) {
                if (twin[h] != kNone) return;
                twin[h] = twinOf(h, a, b);
                if (twin[h] != kNone) twin[twin[h]] = h;
            });
            return;
        }
        constexpr std::int64_t kPiece = 1 << 13;
        parallelForPieces(std::ssize(triangles), kPiece, [&](std::int64_t begin, std::int64_t end) {
            forEachOf(begin, end, [&](Index h, Index a, Index b) { twin[h] = twinOf(h, a, b); });
        });
    }

private:
    /// Calls f(half-edge, from, to) for those of the triangles [begin, end).
    template <class F>
    void forEachOf(std::size_t begin, std::size_t end, const F& f) const {
        for (std::size_t t = begin; t < end; ++t) {
            const auto& [a, b, c] = triangles_[t];
            const auto h = static_cast<Index>(3 * t);
            f(h, a, b);
            f(h + 1, b, c);
            f(h + 2, c, a);
        }
    }

    /// Of several that run from a to b the first goes with the first that runs back, and so on.
    Index twinOf(Index h, Index a, Index b) const {
        std::size_t before = 0;
        for (const Index g : from(a)) {
            if (g == h) break;
            before += to(g) == b ? 1 : 0;
        }
        for (const Index g : from(b)) {
            if (to(g) == a && before-- == 0) return g;
        }
        return kNone;
    }

    std::span<const std::array<Index, 3>> triangles_;
    OrderedBuckets<Index, Index> leaving_;  ///< half-edges, of each vertex
};

}  // namespace adaptiso::detail
