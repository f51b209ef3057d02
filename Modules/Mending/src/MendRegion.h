#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "Lattice.h"
#include "MendInput.h"
#include "WindingField.h"
#include "adaptiso/Core/AabbTree.h"

namespace adaptiso::detail {

/// A point on a lattice face where a triangle's section with it ends: a lattice edge that passes
/// the triangle, or an edge of the mesh that passes the face.
struct FaceNode {
    bool isOnLattice = false;
    std::uint64_t number = 0;  ///< of the lattice edge, or of the mesh's

    friend bool operator==(const FaceNode&, const FaceNode&) = default;
};

/// A triangle's section with a lattice face. Walked from start to end, the part of the triangle
/// above the face, on the side of larger coordinates, is on the left seen from its front.
struct FacePiece {
    std::uint32_t triangle = 0;
    FaceNode start, end;
};

/// The line along which a mesh passes a lattice face, where it is a single one from lattice edge to
/// lattice edge.
struct FaceTrace {
    enum class Kind : std::uint8_t {
        None,    ///< nothing passes; the corners are on one side of the solid's border
        Border,  ///< the solid's: it parts the corners that are inside from the others
        Inner,   ///< not the solid's: the corners are on one side
        Unclear  ///< none of these
    };
    Kind kind = Kind::None;
    std::vector<FacePiece> pieces;  ///< each begins where the one before ends
};

/// The cells of a lattice in which a mesh is replaced: those where it has a fault, and others until
/// the mesh passes every face between them and the rest in one clear line, or not at all.
class MendRegion {
public:
    /// Keeps references to all.
    MendRegion(const MendInput& input, const AabbTree& tree, const WindingField& field,
               const MendLattice& lattice);

    /// Adds the cells at the input's faults.
    void addFaults();
    void add(const std::vector<std::uint64_t>& cells);
    /// Adds cells until all faces are clear.
    void grow();

    bool contains(const LatticePosition& cell) const { return cells_.contains(keyOf(cell)); }
    bool isEmpty() const { return cells_.empty(); }
    std::vector<std::uint64_t> cells() const;  ///< ascending

    /// \pre the face parts a cell of the region from one that is not, and is clear
    const FaceTrace& traceOf(std::uint64_t face) const;
    /// The winding number. \pre a corner of a cell of the region
    double windingAt(const LatticePosition& corner) const { return winding_.at(keyOf(corner)); }
    bool isInside(const LatticePosition& corner) const { return windingAt(corner) >= kInside; }
    /// Where the solid's border passes a lattice edge whose ends it parts, 0 to 1.
    double crossingAlong(std::uint64_t edge) const;
    /// Where the plane of a triangle passes a lattice edge, 0 to 1.
    double planeAlong(std::uint64_t edge, std::uint32_t triangle) const;
    /// A triangle of the mesh has a point in the cell.
    bool isTouched(const LatticePosition& cell) const;

    /// Calls visit(cell) for the cells that a triangle may have a point in.
    template <class Visit>
    void forEachCellOf(const Corners& triangle, const Visit& visit) const {
        const BoundingBox box = boxOf(triangle);
        forEachCell(
            lattice_, lattice_.cellOf(box.minimum), lattice_.cellOf(box.maximum),
            [&](const BoundingBox& around) { return mayTouch(triangle, around); }, visit);
    }

private:
    static constexpr double kInside = 0.5;
    static constexpr std::size_t kMostCells = 4'000'000;

    void insert(const LatticePosition& cell);
    void findWindings();
    FaceTrace findTrace(std::uint64_t face) const;

    const MendInput& input_;
    const AabbTree& tree_;
    const WindingField& field_;
    const MendLattice& lattice_;
    std::unordered_set<std::uint64_t> cells_;
    std::vector<std::uint64_t> added_;  ///< since grow()
    std::unordered_map<std::uint64_t, double> winding_;
    std::unordered_map<std::uint64_t, FaceTrace> traces_;  ///< but those of kind None
};

}  // namespace adaptiso::detail
