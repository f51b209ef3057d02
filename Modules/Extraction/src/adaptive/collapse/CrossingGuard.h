#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptive/collapse/ChangedStar.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::detail {

/// Proves that a changed star crosses no triangle near it, and sweeps over no whole piece of the
/// surface on its way there. What can't be proved is refused.
///
/// Near triangles are found by their boxes, in a grid of cubes. Those whose samples all lie in a
/// single sheet are left out, since no other part of the surface comes near them; so most stars
/// need no proof at all (see needsProof). A triangle without samples is left out only between three
/// of those: nothing else tells what is near it. Triangles that share a vertex of the ring are
/// proved together, by their common view (see fanIsClear); planes between two triangles are tried
/// for the others.
///
/// A small piece between the old star and the new one crosses neither, and would lie on the other
/// side of the surface. Of each piece one vertex is marked: a piece that is swept over lies wholly
/// in the tetrahedra between the new vertex and the old triangles, its mark too.
class CrossingGuard {
public:
    /// \param looksEverywhere  all triangles are looked at, and every star is proved
    CrossingGuard(const Patch& patch, const PatchTopology& topology, const MetricFrame& frame,
                  bool looksEverywhere);

    /// A star that is a graph over a plane, in a single sheet that does not fold back along its
    /// ring, can cross nothing.
    bool needsProof(const ChangedStar& changed, bool isCrowded) const {
        return looksEverywhere_ || isCrowded || !changed.isGraph || foldsBack(changed);
    }

    /// \pre the star has not been changed yet
    bool crossesNothing(const ChangedStar& changed);

    /// The star was changed.
    /// \param isSingleSheet  all its samples, one or more, know of no other sheet near them
    void commit(const ChangedStar& changed, bool isSingleSheet);

private:
    /// Single precision, rounded outwards.
    struct Box {
        std::array<float, 3> low, high;
        bool overlaps(const Box& o) const {
            return low[0] <= o.high[0] && o.low[0] <= high[0] && low[1] <= o.high[1] &&
                   o.low[1] <= high[1] && low[2] <= o.high[2] && o.low[2] <= high[2];
        }
    };
    static Box rounded(const BoundingBox& box);

    /// The cubes that a box overlaps, from the first to the last along each axis; by default none.
    struct Cubes {
        std::array<std::int32_t, 3> first{0, 0, 0}, last{-1, -1, -1};
        bool hasRow(std::int32_t y, std::int32_t z) const {
            return first[1] <= y && y <= last[1] && first[2] <= z && z <= last[2];
        }
    };
    /// Cached data of a triangle, side by side: a search reads all of it.
    struct Known {
        Box box;
        bool hasBox = false;  ///< it is known
        bool isGone = false;
        std::uint32_t stamp = 0;  ///< of the last search that has seen it
    };
    /// Some triangles of a cube: side by side, so that one need not wait for the one before.
    struct Entries {
        static constexpr std::uint32_t kMost = 6;
        std::uint32_t next, count = 0;  ///< next: those that the cube has besides
        std::array<std::uint32_t, kMost> triangle;
    };
    void buildGrid();
    std::vector<std::uint8_t> trianglesInSingleSheets() const;
    Cubes cubesOf(const Box& box) const;
    template <class F>
    void forEachRow(const Cubes& cubes, const F& f) const;
    void enter(std::uint32_t triangle);
    const Box& boxAt(std::uint32_t triangle);
    Corners cornersOf(std::uint32_t triangle) const { return patch_.view().cornersOf(triangle); }
    bool foldsBack(const ChangedStar& changed) const;
    bool wedgesAreClear(const ChangedStar& changed) const;
    bool fanIsClear(const ChangedStar& changed, int at) const;
    bool isClear(const ChangedStar& changed, int wedge, std::uint32_t other) const;
    void collectNear(const ChangedStar& changed);
    void collectAroundRing(const Star& star);
    void collectFromGrid();
    void addNear(std::uint32_t triangle);
    void markPieces();
    void enterMark(std::uint32_t piece);
    void moveMark(const Star& star);
    bool sweepsOver(const ChangedStar& changed) const;

    const Patch& patch_;
    const PatchTopology& topology_;
    bool looksEverywhere_;
    double gapMm_, cubeMm_;
    Vec3 low_;                              ///< of the grid
    std::array<std::int32_t, 3> count_{};   ///< of its cubes, by axis
    std::vector<std::uint32_t> entriesAt_;  ///< of each cube
    std::vector<Entries> entries_;          ///< some are of triangles that have changed since
    std::vector<Cubes> entered_;            ///< of each triangle: those that it was last entered in
    std::vector<Known> known_;              ///< of each triangle; empty until the grid is built
    std::uint32_t now_ = 0;                 ///< the search
    std::vector<std::uint32_t> near_;
    Box starBox_{};
    std::array<std::array<float, Star::kMost>, 3> wedgeLow_{}, wedgeHigh_{};  ///< by axis
    std::array<bool, Star::kMost + 1> fanIsClear_{};  ///< of each vertex of the ring

    std::vector<std::uint32_t> pieceOf_;  ///< of each vertex; empty where all are of one piece
    std::vector<std::uint32_t> marks_;    ///< of each piece: one of its vertices
    /// Pieces by the cubes of their marks; some marks have moved since, and are in both.
    std::vector<std::vector<std::uint32_t>> marksAt_;
};

}  // namespace adaptiso::detail
