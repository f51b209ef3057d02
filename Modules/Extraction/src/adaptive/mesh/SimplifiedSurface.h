#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {

/// Parts of a surface that rounds of simplification change, in the metric frame.
struct SurfaceState {
    using Number = std::uint32_t;  ///< of a point or a triangle
    using Triangle = std::array<Number, 3>;

    /// Points, and triangles, that a surface may have: half-edges are numbered in 32 bits too.
    static constexpr std::size_t kMost = ~Number{0} / 3;

    std::vector<Vec3> points;
    std::vector<Patch::State> states;  ///< of each point
    /// Per point: Patch::kPlain; Patch::kBorder on an open border that may be simplified;
    /// above, a number of the point's own, by which it is known in the end. Empty: all are plain.
    std::vector<std::uint32_t> marks;
    /// Per point, relative to it. Empty once nothing is collapsed or fitted any more, and where
    /// nothing ever can be.
    std::vector<StoredQuadric> quadrics;
    std::vector<Triangle> triangles;
    std::vector<Number> sampleTriangle;  ///< that each sample is assigned to
    /// Per vertex of the full-resolution surface: the point that it was merged into, or still is.
    /// Empty: not asked for.
    std::vector<Number> heirs;

    TriangleView view() const { return {points, triangles}; }
    std::int64_t triangleCount() const { return static_cast<std::int64_t>(triangles.size()); }
};

/// A full-resolution surface, metric frame. Nothing changes it.
struct FineMesh {
    std::vector<Vec3> points;
    std::vector<SurfaceState::Triangle> triangles;
};

/// The whole surface between rounds of simplification, and the samples of the full-resolution one.
struct SimplifiedSurface : SurfaceState {
    static constexpr Number kGone = ~Number{0};
    static constexpr std::size_t kMostSamples = ~Number{0};

    /// The full-resolution surface's vertices in their order, and between them middles of its
    /// triangles.
    std::vector<Sample> samples;
    FineMesh fine;  ///< of a volume; empty for a mesh, which is there already

    std::int64_t fineTriangles = 0;   ///< of the full-resolution surface
    std::int64_t tableTriangles = 0;  ///< of it, were no loop filled from its middle

    SurfaceState& state() { return *this; }

    /// Gives up all that leads back to the full-resolution surface.
    void forgetFull() { freeMemory(samples, sampleTriangle, heirs, fine.points, fine.triangles); }

    /// To be called between steps; small surfaces are not worth the time.
    void returnFreedMemory() const {
        constexpr std::int64_t kLarge = std::int64_t{1} << 16;
        if (fineTriangles >= kLarge) adaptiso::returnFreedMemory();
    }
};

/// Twice the sum of the area vectors around each point.
std::vector<Vec3> areasAround(const TriangleView& surface);

/// Per point, of the planes of the triangles around it.
std::vector<Quadric> quadricsOf(const TriangleView& surface);
/// Gives each point that of the triangles around it.
void setQuadrics(SimplifiedSurface& surface);

/// Drops triangles that are gone (kGone), and points without one; others keep their order.
/// \param mergedInto  of each point that is gone now, where the surface keeps heirs
void removeGone(SimplifiedSurface& surface, const std::vector<SurfaceState::Number>& mergedInto);

/// Changes of a surface.
struct SurfaceChanges {
    std::vector<SurfaceState::Number>
        triangles;                ///< that are new or changed, or got another number
    std::vector<Corners> before;  ///< of triangles that changed or went
};

/// Gives the numbers of triangles that are gone to the last ones, and tells.
void removeTriangles(std::vector<SurfaceState::Number> gone, SurfaceState& surface,
                     SurfaceChanges& changes);

/// The costs of a round's collapses, patch by patch in the order they were made.
using CollapseCosts = std::vector<std::vector<double>>;

/// The largest cost limit with which a round would still have left `collapses` or fewer made, by
/// the costs of the round.
double costLimitFor(const CollapseCosts& costs, std::int64_t collapses);

}  // namespace adaptiso::detail
