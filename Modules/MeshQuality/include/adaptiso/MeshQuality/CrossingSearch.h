#pragma once

#include <cstdint>
#include <optional>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/ClearFans.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// Finds the pairs of triangles of a mesh that cross, as trianglesCross() has it. Near pairs come
/// from a tree of boxes. Most are proved clear by a fan (ClearFans) or a plane (Certificate.h); the
/// others are decided exactly.
///
/// Cost: O(T log T + pairs of overlapping boxes), in parallel; 40 bytes a triangle, and those of
/// ClearFans. Keeps a reference to the mesh's points and triangles.
class CrossingSearch {
public:
    /// \pre the corners of triangles are finite
    explicit CrossingSearch(const TriangleView& mesh);

    /// Pieces that are searched side by side.
    std::int64_t pieceCount() const { return (tree_.leafCount() + kPiece - 1) / kPiece; }

    /// Calls visit(piece, a, b), a < b, once for each pair that crosses, side by side for different
    /// pieces; within one always in the same order.
    /// \param isAsked  isAsked(a, b): the pair is looked at
    template <class IsAsked, class Visit>
    void forEachPair(const IsAsked& isAsked, const Visit& visit) const {
        if (mesh_.triangles.empty()) return;
        const TriangleTree::Pairs pairs(tree_, mesh_);
        parallelForPieces(tree_.leafCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
            pairs.forEach(begin, end, [&](std::uint32_t a, std::uint32_t b) {
                if (isAsked(a, b) && cross(a, b)) visit(begin / kPiece, a, b);
            });
        });
    }
    template <class Visit>
    void forEachPair(const Visit& visit) const {
        forEachPair([](std::uint32_t, std::uint32_t) { return true; }, visit);
    }

private:
    static constexpr std::int64_t kPiece = 128;  ///< leaves

    bool cross(std::uint32_t a, std::uint32_t b) const;

    TriangleView mesh_;
    double gap_;  ///< what rounding of coordinates may hide
    TriangleTree tree_;
    std::optional<ClearFans> fans_;
};

}  // namespace adaptiso
