#pragma once

#include <cstdint>
#include <cstring>
#include <unordered_map>
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

/// Pieces as one mesh.
class PieceUnion {
public:
    void add(const Piece& piece) {
        constexpr VertexId kNew = -1;
        std::vector<VertexId> number(piece.mesh.points.size(), kNew);
        for (const BorderVertex& v : piece.summary.border) {
            const auto [at, isNew] = known_.try_emplace(v.index, std::ssize(mesh_.points));
            if (isNew) append(piece.mesh, v.vertex);
            number[v.vertex] = at->second;
        }
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] != kNew) continue;
            number[v] = std::ssize(mesh_.points);
            append(piece.mesh, v);
        }
        for (const auto& [a, b, c] : piece.mesh.triangles) {
            mesh_.triangles.push_back({number[a], number[b], number[c]});
        }
    }
    const TriangleMesh& mesh() const { return mesh_; }

private:
    void append(const TriangleMesh& mesh, std::size_t v) {
        mesh_.points.push_back(mesh.points[v]);
        mesh_.normals.push_back(mesh.normals[v]);
    }

    TriangleMesh mesh_;
    AtPlace<VertexId> known_;
};

}  // namespace adaptiso::giant
