#pragma once

#include <array>

#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso::detail {

/// Tells whether a change of walls takes them over a voxel centre.
class SweptCentres {
public:
    explicit SweptCentres(const ImageGeometry& geometry)
        : originMm_(geometry.originMm), toIndex_(inverse(geometry.indexToPhysical)) {}

    /// A voxel centre lies in a tetrahedron (voxel indices), or so near to it that rounding could
    /// tell otherwise. Replacing triangles round an edge by the cone of a new point over their
    /// border sweeps the tetrahedra of these triangles and the point, and no more.
    static bool isCentreIn(const std::array<Vec3, 4>& corners);

    Vec3 toIndex(const Vec3& pointMm) const { return toIndex_ * (pointMm - originMm_); }

private:
    Vec3 originMm_;
    Mat3 toIndex_;
};

}  // namespace adaptiso::detail
