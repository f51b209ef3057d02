#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "PieceFile.h"

namespace adaptiso::giant {

/// Places by their bits: vertices on the borders of pieces that have the same are one.
struct HashOfBits {
    std::size_t operator()(const Vec3& p) const {
        std::uint64_t hash = 0;
        for (int a = 0; a < 3; ++a) {
            std::uint64_t bits = 0;
            const double along = p[a];
            std::memcpy(&bits, &along, sizeof bits);
            hash = (hash ^ (bits ^ bits >> 29)) * 0x9E3779B97F4A7C15u;
        }
        return hash;
    }
};
struct SameBits {
    bool operator()(const Vec3& p, const Vec3& q) const {
        return std::memcmp(&p, &q, sizeof p) == 0;
    }
};
template <class T>
using AtPlace = std::unordered_map<Vec3, T, HashOfBits, SameBits>;

/// The border between pieces read and pieces to come: the vertices that have an edge whose
/// other triangle has not been seen. Once it has, the surface is closed around a vertex, no other
/// piece has it, and it is forgotten. So of pieces that come layer by layer about a layer's borders
/// are held, however many layers there are: 150 bytes for each of their vertices.
class BorderFront {
public:
    static constexpr VertexId kNoNumber = -1;

    struct Vertex {
        std::uint64_t serial = 0;  ///< of all vertices on borders
        std::int64_t openEdges = 0;
        VertexId number = kNoNumber;  ///< the caller's
        std::uint32_t part = 0;       ///< the caller's
        bool isNew = false;           ///< no piece before the last had it
    };

    /// The piece's border vertices in the order of its summary, until the next call of release().
    std::vector<Vertex*> add(const PieceSummary& piece);

    /// Forgets those vertices of the piece added last around which the surface is closed.
    /// \param forget  is called with each of them
    template <class Forget>
    void release(const PieceSummary& piece, const Forget& forget) {
        for (const BorderVertex& v : piece.border) {
            const auto at = vertices_.find(v.index);
            if (at == vertices_.end() || at->second.openEdges > 0) continue;
            forget(at->second);
            vertices_.erase(at);
        }
    }

    /// Edges with one triangle, of all pieces so far.
    std::int64_t openEdges() const { return std::ssize(open_); }
    /// Vertices that ever were on it, and the most that were at once.
    std::uint64_t seen() const { return seen_; }
    std::int64_t longest() const { return longest_; }

private:
    using Edge = std::array<std::uint64_t, 2>;
    struct EdgeHash {
        std::size_t operator()(const Edge& e) const {
            return (e[0] * 0x9E3779B97F4A7C15u ^ e[1]) * 0xD6E8FEB86659FD93u;
        }
    };

    AtPlace<Vertex> vertices_;
    std::unordered_set<Edge, EdgeHash> open_;
    std::uint64_t seen_ = 0;
    std::int64_t longest_ = 0;
};

}  // namespace adaptiso::giant
