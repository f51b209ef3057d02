#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptive/collapse/PatchSimplifier.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// The full-resolution surface that the adaptive method simplifies: of a volume (VolumeSurface), or
/// a mesh (MeshSurface).
class FullSurface {
public:
    explicit FullSurface(const MetricFrame& frame) : frame_(frame) {}
    FullSurface(const FullSurface&) = delete;
    FullSurface& operator=(const FullSurface&) = delete;
    FullSurface(FullSurface&&) = delete;
    FullSurface& operator=(FullSurface&&) = delete;
    virtual ~FullSurface() = default;

    const MetricFrame& frame() const { return frame_; }

    /// The surface after a first round within the limits.
    /// \param costs  gets those of the collapses, patch by patch; may be null
    virtual SimplifiedSurface firstRound(const PatchLimits& limits, CollapseCosts* costs) const = 0;

    /// The full-resolution surface itself, metric frame.
    /// \param surface  made of it by firstRound(); a volume's is kept there
    virtual TriangleView fineOf(const SimplifiedSurface& surface) const = 0;

    /// In physical coordinates. Triangles keep their numbers.
    virtual TriangleMesh meshOf(const SimplifiedSurface& surface) const = 0;

    /// Triangles that cross others in physical coordinates, ascending; without those that did so
    /// from the beginning.
    /// \param isFine  of each triangle: 1 for those that the full surface has, too
    virtual std::vector<std::int64_t> crossingTriangles(
        const SimplifiedSurface& surface, const std::vector<std::uint8_t>& isFine) const = 0;

    /// Triangles of pieces that are inside out, and were not from the beginning. Where the surface
    /// is open there is no inside: nothing is judged by it.
    virtual std::vector<std::int64_t> insideOut(const SimplifiedSurface& surface) const = 0;

    /// No two points of the surface are farther apart, mm.
    virtual double largestExtentMm() const = 0;

    /// Where new vertices stay, metric frame; none: anywhere.
    const std::optional<BoundingBox>& box() const { return box_; }

protected:
    void keepIn(const BoundingBox& box) { box_ = box; }

private:
    MetricFrame frame_;
    std::optional<BoundingBox> box_;
};

}  // namespace adaptiso::detail
