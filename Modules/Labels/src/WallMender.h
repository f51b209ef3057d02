#pragma once

#include <cstdint>
#include <vector>

#include "WallCollapser.h"
#include "WallProof.h"
#include "adaptiso/Core/Buckets.h"

namespace adaptiso::detail {

/// Triangles by the cubes of space that their boxes reach.
class TrianglesByPlace {
public:
    TrianglesByPlace(const CornerBox& box, double cubeMm);

    /// Takes these triangles instead of any before, each wider by a distance.
    void assign(const WallMesh& mesh, const std::vector<WallMesh::Id>& triangles, double aroundMm);
    /// One of the triangle's wall is there whose box, made wider, overlaps the triangle's.
    bool isOneNear(WallMesh::Id triangle) const;

private:
    /// The cubes along the axes, first and last, that a box reaches.
    std::array<std::array<std::int64_t, 2>, 3> rangeOf(const CornerBox& box) const;
    template <class F>
    void forEachCube(const CornerBox& box, const F& f) const;

    double cubeMm_;
    Vec3 low_;
    std::array<std::int64_t, 3> count_{};
    const WallMesh* mesh_ = nullptr;
    double aroundMm_ = 0;
    Buckets<WallMesh::Id, std::uint32_t> cubes_;
};

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
    void blameNear(const WallPlace& place);
    void findCrossings();
    void forgetChanged();
    WallSurface fullNear(const std::vector<Id>& triangles);
    void findBeyond();

    WallCollapser& collapser_;
    const WallMesh& mesh_;
    double limitMm_, boundMm_;
    bool mayGrow_;
    TrianglesByPlace near_;
    std::vector<std::uint8_t> isClear_;       ///< of triangles: known to cross nothing
    std::vector<std::uint8_t> isProved_;      ///< of triangles: within the limit of the full walls
    std::vector<std::uint8_t> isLast_;        ///< of triangles: alive when last proved
    std::vector<std::uint8_t> isFullProved_;  ///< of triangles of the full walls
    std::vector<Id> changes_;                 ///< to take back
};

}  // namespace adaptiso::detail
