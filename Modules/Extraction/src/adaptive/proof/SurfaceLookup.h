#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

inline std::array<Corners, 4> quarter(const Corners& t) {
    const Vec3 a = 0.5 * (t[0] + t[1]), b = 0.5 * (t[1] + t[2]), c = 0.5 * (t[2] + t[0]);
    return {{{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}}};
}

/// Triangles of a simplified surface by the bricks whose neighbourhood they reach into, and by
/// their places. Keeps a reference to the surface.
class SurfaceLookup {
public:
    SurfaceLookup(const SimplifiedSurface& surface, const Bricks& bricks, const MetricFrame& frame);

    /// To be called once the surface has changed, before anything else is asked.
    /// \param changed  its triangles that are new or changed, or got another number
    void update(std::vector<SurfaceState::Number> changed);

    const Bricks& bricks() const { return bricks_; }
    const MetricFrame& frame() const { return frame_; }

    std::uint64_t triangleCount() const { return surface_.triangles.size(); }
    Corners cornersOf(std::uint64_t t) const {
        const SurfaceState::Triangle& c = surface_.triangles[t];
        return {surface_.points[c[0]], surface_.points[c[1]], surface_.points[c[2]]};
    }
    const SurfaceState::Triangle& triangle(std::uint64_t t) const { return surface_.triangles[t]; }
    const Vec3& point(SurfaceState::Number v) const { return surface_.points[v]; }
    /// Calls f(t) for all triangles that may lie within a distance of a piece.
    template <class F>
    void forEachNear(const Corners& piece, double distanceMm, const F& f) const {
        BoundingBox box = boxOf(piece);
        box.widen(distanceMm);
        tree().forEachOverlap(box, view(), f);
    }
    const WalkableSurface<SurfaceState::Number>& walkable() const { return walkable_; }
    std::span<const SurfaceState::Number> ofBrick(std::int64_t b) const {
        return ofBrick_.of(static_cast<std::size_t>(b));
    }
    /// ofBrick() has all triangles within a distance of the brick.
    bool ofBrickHasAllWithin(double distanceMm) const {
        return distanceMm <= kMargin * frame_.narrowestMm();
    }

    /// Calls f(brick) for the bricks whose neighbourhood a triangle reaches into.
    template <class F>
    void forEachBrickNear(std::uint64_t t, const F& f) const {
        const auto [first, last] = placesNear(t);
        for (std::int64_t z = first[2]; z <= last[2]; ++z) {
            for (std::int64_t y = first[1]; y <= last[1]; ++y) {
                for (std::int64_t x = first[0]; x <= last[0]; ++x) {
                    const std::int64_t b = bricks_.at({x, y, z});
                    if (b != Bricks::kNone) f(b);
                }
            }
        }
    }

    /// Lattice position (continuous) of a point of the metric frame.
    Vec3 latticeOf(const Vec3& p) const {
        const auto offset = static_cast<double>(bricks_.grid().offset);
        return frame_.toIndex(p) + Vec3{offset, offset, offset};
    }

    /// The brick that answers for a point: the one that it lies in, or else the first one that has
    /// it in its halo with a margin around; kNone where there is none.
    std::int64_t brickFor(const Vec3& lattice) const;

    /// A piece is not cut further: its box is no larger than a cell.
    bool isSmall(const Corners& piece) const;

    /// All of a piece lies in the brick or in its halo with a margin around.
    bool isWithinReach(std::int64_t brick, const Corners& piece) const;

private:
    static constexpr double kMargin = BrickMesher::kHalo / 2.0;

    static bool isNear(const Brick& brick, const Vec3& lattice);

    /// First and last of the bricks' places that a triangle reaches into, with a margin around.
    std::pair<Index3, Index3> placesNear(std::uint64_t t) const;

    TriangleView view() const { return {surface_.points, surface_.triangles}; }
    /// Built when it is first asked for.
    const TriangleTree& tree() const;

    const SurfaceState& surface_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    std::unique_ptr<std::once_flag> treeIsBuilt_ = std::make_unique<std::once_flag>();
    mutable TriangleTree tree_;
    WalkableSurface<SurfaceState::Number> walkable_;
    Buckets<SurfaceState::Number> ofBrick_;
};

}  // namespace adaptiso::detail
