#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "adaptiso/Core/Buckets.h"

namespace adaptiso::detail {

/// The half-edges of triangles by the vertex that they start from. Half-edge 3 t + c runs from
/// corner c of triangle t to the next corner.
template <class Index>
class HalfEdges {
public:
    static constexpr Index kNone = std::numeric_limits<Index>::max();

    struct Leaving {
        Index to, halfEdge;
    };

    void assign(std::size_t points, std::span<const std::array<Index, 3>> triangles) {
        leaving_.assign(points, [&](const auto& give) {
            Index h = 0;
            for (const auto& [a, b, c] : triangles) {
                give(a, {b, h++});
                give(b, {c, h++});
                give(c, {a, h++});
            }
        });
    }

    /// In ascending order.
    std::span<const Leaving> from(Index vertex) const { return leaving_.of(vertex); }

    /// The opposite of each half-edge, or kNone. Where several run along an edge they are matched
    /// in ascending order.
    void match(std::span<const std::array<Index, 3>> triangles, std::vector<Index>& twin) const {
        twin.assign(3 * triangles.size(), kNone);
        Index h = 0;
        for (const auto& [a, b, c] : triangles) {
            matchOne(h++, a, b, twin);
            matchOne(h++, b, c, twin);
            matchOne(h++, c, a, twin);
        }
    }

private:
    void matchOne(Index h, Index a, Index b, std::vector<Index>& twin) const {
        if (twin[h] != kNone) return;
        for (const Leaving& l : from(b)) {
            if (l.to != a || twin[l.halfEdge] != kNone) continue;
            twin[h] = l.halfEdge;
            twin[l.halfEdge] = h;
            return;
        }
    }

    Buckets<Leaving, Index> leaving_;  ///< of each vertex
};

}  // namespace adaptiso::detail
