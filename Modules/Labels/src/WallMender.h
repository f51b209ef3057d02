#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "TriangleGrid.h"
#include "WallCollapser.h"
#include "WallProof.h"

namespace adaptiso::detail {

/// Proves what the collapses made, and takes back what breaks a promise.
class WallMender {
public:
    /// What was there before the collapses is taken for proved. \param collapser  must live as long
    WallMender(WallCollapser& collapser, double limitMm, bool mayGrow);

    double boundMm() const { return boundMm_; }

    /// Takes back what breaks a promise. \return false when nothing does
    bool mend();

private:
    using Id = WallMesh::Id;
    static constexpr Id kNone = WallMesh::kNone;

    void blame(Id triangle);
    void blameNear(const std::vector<WallPlace>& places);
    void findCrossings();
    void forgetChanged();
    void keepWitnesses(const std::vector<Id>& full, const WallBound& bound);
    std::vector<Id> fullOver(const std::vector<Id>& triangles) const;
    std::vector<Id> unprovedTriangles() const;
    std::vector<Id> unprovedFull() const;
    std::vector<Id> aliveTriangles(bool areAll, const std::vector<Id>& full) const;
    void proveByMap();
    const WallSurface& fullNear(const std::vector<Id>& triangles);
    void findBeyondOfSimple();
    void findBeyondOfFull();
    BoundingBox boxAround(Id triangle, double distanceMm) const;

    WallCollapser& collapser_;
    const WallMesh& mesh_;
    double limitMm_, boundMm_;
    bool mayGrow_;
    SpaceCells cells_;
    TriangleGrid full_;  ///< triangles of the full walls; none where the walls began as these
    std::optional<WallSurface> wholeFull_, nearFull_;
    std::vector<std::uint8_t> isClear_;       ///< of triangles: known to cross nothing
    std::vector<std::uint8_t> isProved_;      ///< of triangles: within the limit of the full walls
    std::vector<std::uint8_t> isLast_;        ///< of triangles: alive when last proved
    std::vector<std::uint8_t> isFullProved_;  ///< of triangles of the full walls
    /// Of triangles of the full walls, since they were proved: what they lie near.
    struct Witnesses {
        Id begin = 0, count = 0;
    };
    std::vector<Witnesses> witnessesOf_;
    std::vector<Id> witnesses_;
    std::vector<Id> changes_;  ///< to take back
};

}  // namespace adaptiso::detail
