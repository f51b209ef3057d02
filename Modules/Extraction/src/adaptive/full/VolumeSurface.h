#pragma once

#include <optional>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/full/FullSurface.h"

namespace adaptiso::detail {

/// The marching cubes surface of a volume, made brick by brick. Keeps references to all it is
/// given.
class VolumeSurface final : public FullSurface {
public:
    VolumeSurface(const ImageGeometry& geometry, const LatticeSampler& sampler,
                  const Bricks& bricks);

    /// For a part of a surface whose open border is shared with others: all outside `moving` stays
    /// at full resolution, and new vertices stay in `box`.
    /// \param moving  continuous sample indices \param box  metric frame
    void stayIn(const BoundingBox& moving, const BoundingBox& box);

    SimplifiedSurface firstRound(const PatchLimits& limits, CollapseCosts* costs) const override;
    TriangleView fineOf(const SimplifiedSurface& surface) const override {
        return {surface.fine.points, surface.fine.triangles};
    }
    TriangleMesh meshOf(const SimplifiedSurface& surface) const override;
    std::vector<std::int64_t> crossingTriangles(
        const SimplifiedSurface& surface, const std::vector<std::uint8_t>& isFine) const override;
    /// Per triangle, the cell that it is known to lie in, such that those of different cells do not
    /// cross; kNoCell if unknown. Empty if unknown for all.
    /// \param isFine  as above
    std::vector<std::uint64_t> cellsOf(const SimplifiedSurface& surface,
                                       const std::vector<std::uint8_t>& isFine) const;
    std::vector<std::int64_t> insideOut(const SimplifiedSurface& surface) const override;
    double largestExtentMm() const override;

private:
    std::vector<Vec3> physicalPoints(const SimplifiedSurface& surface) const;
    std::uint8_t facesAt(const Vec3& point) const;
    bool roundsFinely() const;

    const ImageGeometry& geometry_;
    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    std::optional<BoundingBox> moving_;
};

}  // namespace adaptiso::detail
