#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/proof/DistanceProof.h"

namespace adaptiso::detail {

/// Mends a simplified surface where it lies beyond the bound: brings it to the full-resolution
/// surface there by a new vertex, as greedy insertion refines terrains [Garland1995].
///
/// The triangle of the place is split in three; beside an edge the edge is split, with the two
/// triangles at it; beside a vertex that moves. Where none of these is allowed an edge of the
/// triangle is collapsed. A change is allowed if no triangle
/// turns too far, none crosses another, and no sample is taken beyond the bound.
///
/// Vertices keep their numbers; those that collapses leave without a triangle stay in the list.
class SurfaceMender {
public:
    /// \param limitMm  the bound
    /// \param box      that new and moved vertices stay in, if any
    SurfaceMender(SimplifiedSurface& surface, const MetricFrame& frame, double limitMm,
                  const std::optional<BoundingBox>& box = {});

    /// Mends the farthest places first, and skips those that the surface has left by then.
    /// \return how many were mended
    std::size_t mendDistances(std::vector<PlaceBeyond> places);

    /// Changes triangles that cross others until they don't, where that can be done.
    /// \param mergesFirst  new vertices only where no merging of two helps: a wanted count of
    ///                     triangles is not passed then but in few places
    /// \return how many were changed
    std::size_t mendCrossings(const std::vector<std::int64_t>& triangles, bool mergesFirst);

    /// Since the last call of this function.
    SurfaceChanges takeChanges() { return std::exchange(changes_, {}); }
    /// All triangles that were changed, before and after.
    const std::vector<SurfaceState::Triangle>& changedTriangles() const { return changed_; }

private:
    using Triangle = SurfaceState::Triangle;
    using Number = SurfaceState::Number;
    using Numbers = std::vector<Number>;
    static constexpr Number kNone = ~Number{0};
    static constexpr std::size_t kSlots = std::size_t{1} << 18;

    /// The edge from a to b with its triangles (a, b, c) and (b, a, d), the twin.
    struct Edge {
        Number a, b, c, d, twin;
    };

    template <class Mend>
    std::size_t mendAll(const std::vector<PlaceBeyond>& places, const Mend& mend);
    void prepare(const std::vector<PlaceBeyond>& places);
    void forget();
    bool mendPlace(const PlaceBeyond& place);
    bool mendCrossing(Number triangle, bool mergesFirst);
    bool mergeCorners(Number triangle);
    bool insert(const PlaceBeyond& place, Number triangle, const std::array<double, 3>& at);
    Number partAt(const PlaceBeyond& place) const;
    bool moveVertex(Number vertex, const Vec3& step);
    bool splitEdge(Number triangle, int corner, const Vec3& point);
    bool split(const Numbers& triangles, const std::vector<Triangle>& parts, const Vec3& point);

    bool collapseEdge(Number triangle, int corner, const PlaceBeyond& place);
    bool mayMerge(const Edge& edge) const;

    bool mayMove(Number vertex) const;
    std::optional<std::vector<Corners>> movedCorners(const Numbers& triangles, Number a, Number b,
                                                     const Vec3& target) const;
    bool facesAs(const Corners& now, const Corners& before) const;
    bool mayReplace(const Numbers& replaced, const std::vector<Corners>& triangles,
                    const Vec3& vertex) const;
    bool isFree(const Vec3& point, const Numbers& replaced) const;
    bool staysNear(const std::vector<Corners>& triangles, const Numbers& replaced) const;
    bool crossesNothing(const std::vector<Corners>& triangles, const Numbers& replaced) const;

    Corners cornersOf(Number triangle) const { return surface_.view().cornersOf(triangle); }
    bool isTracked(Number vertex) const { return around_.contains(vertex); }
    Number triangleOf(Number from, Number to) const;
    std::optional<Edge> edgeAt(Number triangle, int corner) const;
    Number addVertex(const Vec3& point);
    Number addTriangle(const Triangle& triangle, Number parent);
    void leave(Number triangle);
    void replace(Number number, const Triangle& triangle);
    void track(Number triangle);
    void trackBox(Number triangle);
    void note(Number triangle);
    void handOver(const Numbers& from, const Numbers& to);
    template <class F>
    void forEachSlot(const BoundingBox& box, const F& f) const;
    template <class IsMeant>
    bool isAnyNear(const BoundingBox& box, const Numbers& replaced, const IsMeant& isMeant) const;

    SimplifiedSurface& surface_;
    double squaredLimit_, cubeMm_;
    std::optional<BoundingBox> box_;

    SurfaceChanges changes_;
    std::vector<Triangle> changed_;

    // of one call
    Numbers gone_;                                   ///< triangles that collapsed
    std::unordered_map<Number, Numbers> around_;     ///< triangles, of each tracked vertex
    std::unordered_map<Number, Numbers> parts_;      ///< of each triangle that was split
    std::unordered_map<Number, Number> parent_;      ///< of each part
    std::unordered_map<Number, Numbers> samplesOf_;  ///< of triangles around_ has
    /// Triangles by the cubes that their boxes overlap, hashed. Some have changed since.
    std::vector<Numbers> inSlot_;
    std::vector<bool> isSlotNear_;  ///< a change may reach into a cube of it; others hold nothing
};

}  // namespace adaptiso::detail
