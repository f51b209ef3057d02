#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "WallCollapser.h"
#include "WallProof.h"
#include "adaptiso/SurfaceProof/SurfaceMap.h"

namespace adaptiso::detail {

/// Maps triangles of the full walls continuously to the walls as they are, no point farther than a
/// limit: see SurfaceMap. Each wall is mapped to itself, and what ends it to what ends it: a
/// curve's points go to the edges that they are assigned to, its corners to themselves.
///
/// So what is mapped lies within the limit of the walls as they are, and so does each triangle of
/// these that is covered within the limit of the full ones.
class WallMap {
public:
    using Id = WallMesh::Id;

    /// Keeps references to both. \param to  of the collapser's mesh
    WallMap(const WallCollapser& collapser, const WallSurface& to);

    /// Results for triangles of the full walls, in turn.
    struct Result {
        std::vector<std::uint8_t> isMapped;
        /// Number of the mesh's triangles that each goes to, and their numbers.
        std::vector<Id> witnessCounts, witnesses;
    };
    /// \param full  numbers \param areAll  all of a patch whose walls began as the full ones
    Result map(const std::vector<Id>& full, bool areAll, double limitMm);

    /// A triangle of the mesh (number) lies within the limit of what was mapped.
    bool covers(Id triangle) const {
        const Id place = places_[triangle];
        return place != WallMesh::kNone && cover_.covers(place);
    }

private:
    using Map = SurfaceMap<Id>;
    class Mapper;

    /// A vertex that no sample is assigned for: it has not moved.
    struct Still {
        Vec3 point;
        Id vertex;
    };
    Id stillAt(const Vec3& point) const;

    const WallCollapser& collapser_;
    const WallMesh& mesh_;
    const WallSurface& to_;
    std::vector<Id> places_;  ///< in `to`, of the mesh's triangles
    std::vector<Still> still_;
    SharedCover cover_;
};

/// Proves what the collapses made, and takes back what breaks a promise.
class WallMender {
public:
    /// The state before the collapses counts as proved. \param collapser  must live as long
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
    NearTriangles full_;  ///< triangles of the full walls; none where the walls began as these
    std::optional<WallSurface> wholeFull_, nearFull_;
    std::vector<std::uint8_t> isClear_;       ///< of triangles: known to cross nothing
    std::vector<std::uint8_t> isProved_;      ///< of triangles: within the limit of the full walls
    std::vector<std::uint8_t> isLast_;        ///< of triangles: alive when last proved
    std::vector<std::uint8_t> isFullProved_;  ///< of triangles of the full walls
    /// Near triangles of triangles of the full walls, since they were proved.
    struct Witnesses {
        Id begin = 0, count = 0;
    };
    std::vector<Witnesses> witnessesOf_;
    std::vector<Id> witnesses_;
    std::vector<Id> changes_;  ///< to take back
};

}  // namespace adaptiso::detail
