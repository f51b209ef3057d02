#pragma once

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/full/FullSurface.h"

namespace adaptiso::detail {

/// The marching cubes surface of a volume, made brick by brick whenever it is needed. Keeps
/// references to all it is given.
class VolumeSurface final : public FullSurface {
public:
    VolumeSurface(const ImageGeometry& geometry, const LatticeSampler& sampler,
                  const Bricks& bricks);

    SimplifiedSurface firstRound(const TightPlaces& tight, const PatchLimits& limits,
                                 CollapseCosts* costs) const override;
    std::unique_ptr<DistanceProof> proof(double limitMm) const override;
    TriangleMesh meshOf(const SimplifiedSurface& surface) const override;
    Vec3 indexOf(const Vec3& point) const override { return geometry_.toIndex(point); }
    void forgiveCrossings(const TriangleMesh&, std::vector<std::int64_t>&) const override {}
    double largestExtentMm() const override;

private:
    void keepCorners(SimplifiedSurface& surface) const;

    const ImageGeometry& geometry_;
    const LatticeSampler& sampler_;
    const Bricks& bricks_;
};

}  // namespace adaptiso::detail
