#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

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
        begin_.assign(points + 2, 0);
        for (const auto& t : triangles) {
            for (const Index v : t) ++begin_[v + 2];
        }
        for (std::size_t v = 2; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
        leaving_.resize(3 * triangles.size());
        Index h = 0;
        for (const auto& [a, b, c] : triangles) {  // begin_[v + 1] grows to the end of v's
            leaving_[begin_[a + 1]++] = {b, h++};
            leaving_[begin_[b + 1]++] = {c, h++};
            leaving_[begin_[c + 1]++] = {a, h++};
        }
    }

    /// In ascending order.
    std::span<const Leaving> from(Index vertex) const {
        return {leaving_.data() + begin_[vertex], leaving_.data() + begin_[vertex + 1]};
    }

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

    std::vector<Index> begin_;
    std::vector<Leaving> leaving_;
};

}  // namespace adaptiso::detail
