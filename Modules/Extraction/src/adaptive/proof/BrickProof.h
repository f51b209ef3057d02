#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptiso/SurfaceProof/SurfaceMap.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"
#include "adaptiso/SurfaceProof/ZeroedTable.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/bricks/SampleNumbers.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/mesh/WholeBricks.h"
#include "adaptive/proof/BoxList.h"
#include "adaptive/proof/DistanceProof.h"
#include "adaptive/proof/SurfaceLookup.h"

namespace adaptiso::detail {

/// What is proved of the surfaces within a brick.
struct BrickBound {
    double provedMm = 0;    ///< bound of all that lies within the limit
    double farthestMm = 0;  ///< bound of the rest
    std::vector<PlaceBeyond> beyondLimit;
    double provedArea = 0;  ///< of the simplified surface, mm2
};

/// What is to be proved; all where the lists are empty.
struct ProofScope {
    std::vector<std::uint8_t> isKnown;  ///< of each triangle of the simplified one: proved before
    std::vector<bool> blocks;  ///< those whose part of the full-resolution surface is to be proved

    bool isProved(std::uint64_t triangle) const {
        return !isKnown.empty() && isKnown[triangle] != 0;
    }
    bool isWanted(std::uint64_t block) const { return blocks.empty() || blocks[block]; }
    /// A block within reach of the mesher's halo is wanted.
    bool isNearWanted(std::uint32_t block, const BlockGrid& grid) const;
};

/// Proves bounds of the distance between the full-resolution surface, made anew, and the simplified
/// one, brick by brick; keeps its working memory between bricks.
///
/// Each surface is cut into pieces along walks on the other one (see SurfaceWalk); what a walk
/// can't settle is left to PieceBound.
class BrickProof {
public:
    /// \param whole    bricks in which both surfaces are the same: there nothing is to be proved
    /// \param numbers  learnt where all is to be proved, used else
    /// \param enoughMm  no bound need be tighter
    /// \param limitMm   pieces farther off are noted, and do not loosen the bound of the rest
    BrickProof(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
               const WholeBricks& whole, const LatticeSampler& sampler, const ProofScope& scope,
               SampleNumbers& numbers, double enoughMm, double limitMm);

    BrickBound prove(std::int64_t brick);

private:
    using Number = SurfaceState::Number;
    using Walkable = WalkableSurface<Number>;
    static constexpr Number kNone = Walkable::kNone;

    void findAssigned();
    void findAssignedByPlace();
    void findUnmoved();
    bool isUnchanged(const std::array<std::uint32_t, 3>& fine);
    void findStarts(std::span<const Number> triangles);
    void rememberCells();
    void forgetCells();

    bool isIdle() const;
    std::optional<BrickBound> boundOfWhole();
    void proveOwnCells();
    void proveTriangles();
    std::uint64_t blockOf(const FineSurface::Cell& cell) const;
    using Map = SurfaceMap<Number>;

    bool mapFine(std::uint32_t t);
    const Map::Vertex* mappedVertex(std::uint32_t v);
    Map::Side sideOf(std::uint32_t halfEdge, const Map::Vertex& a, const Map::Vertex& b);
    std::uint32_t edgeOf(std::uint32_t halfEdge) const;
    void findCovered();
    void proveFine(std::size_t t);
    void proveFinePart(const Corners& piece, const std::array<std::uint32_t, 3>& of);
    void collectWithin(double distanceMm, const Corners& piece);
    void collectAround(const std::array<std::uint32_t, 3>& fine);
    template <class F>
    void forEachPieceHere(const Corners& piece, double area2, const F& f) const;
    void proveWhole(const Corners& piece, std::uint32_t start, double area2);
    template <class Index>
    void cover(const Corners& piece, const WalkableSurface<Index>& surface, Index start,
               double squaredDistance, int steps);
    void proveSmall(const Corners& piece);
    void proveLeaf(const Corners& piece, const BoundingBox& box);

    BoundingBox latticeBox(const Corners& piece) const;
    std::uint32_t nearestFine(const Vec3& p);
    void collectNear(const BoundingBox& box, double reach);
    void keepNearest(const Corners& piece);

    const SimplifiedSurface& surface_;
    const SurfaceLookup& lookup_;
    const WholeBricks& whole_;
    const MetricFrame& frame_;
    const ProofScope& scope_;
    SampleNumbers& numbers_;
    double enoughMm_, limitMm_;
    BrickMesher mesher_;

    std::int64_t brick_ = 0;
    Index3 low_{};
    FineSurface fine_;
    std::vector<Vec3> points_;  ///< of the fine surface, metric frame
    Walkable walkable_;
    std::vector<std::uint32_t> numberOf_;  ///< of each of the brick's own fine vertices, the sample
    /// Of each of the brick's own fine vertices the triangle that it is assigned to; kNone where
    /// the block that it comes with is not meshed.
    std::vector<Number> assigned_;
    /// For each of the brick's own fine vertices the vertex of the simplified surface in its place.
    std::vector<Number> unmoved_;
    std::vector<Number> unchanged_;       ///< triangles that are fine ones too, ascending
    std::vector<std::uint32_t> startAt_;  ///< a fine triangle at each of the brick's triangles
    ZeroedTable cellAt_;                  ///< number + 1
    Number triangle_ = 0;                 ///< whose pieces are looked at

    BoxList boxes_;  ///< of the brick's triangles; empty until they are asked for

    PieceBound fromFine_, toFine_;
    BrickBound result_;
    SurfaceWalk walk_;
    std::vector<std::uint32_t> near_;
    std::vector<Number> around_;
    std::vector<Number> within_;  ///< the triangles that collectWithin() found
    std::vector<std::pair<double, std::uint32_t>> ranked_;

    // of the brick's own fine surface
    Map map_;
    MapCover<Number> cover_;
    std::vector<Map::Vertex> mapped_;     ///< of each vertex; a distance of -1: not looked at
    std::vector<Map::Way> ways_;          ///< of each edge, by its first half-edge
    std::vector<std::uint8_t> isMapped_;  ///< of each triangle
};

}  // namespace adaptiso::detail
