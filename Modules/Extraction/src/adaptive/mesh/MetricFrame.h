#pragma once

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {

/// Millimetres along axes that fit the lattice: physical space turned (and mirrored, where the
/// image is) so that index axis i runs along x and j in the xy plane. Distances, areas and volumes
/// are those of physical space; orientation is that of index space. Index (0, 0, 0) is the origin.
class MetricFrame {
public:
    explicit MetricFrame(const ImageGeometry& geometry)
        : voxelMm_(portable::cubeRoot(geometry.voxelVolumeMm3())) {
        // QR by Gram-Schmidt: indexToPhysical = Q R, and R is what is wanted
        const auto& c = geometry.indexToPhysical.column;
        const Vec3 x = normalized(c[0]);
        const Vec3 y = normalized(c[1] - dot(x, c[1]) * x);
        const Vec3 rest = c[2] - dot(x, c[2]) * x - dot(y, c[2]) * y;
        toFrame_.column[0] = {norm(c[0]), 0, 0};
        toFrame_.column[1] = {dot(x, c[1]), norm(c[1] - dot(x, c[1]) * x), 0};
        toFrame_.column[2] = {dot(x, c[2]), dot(y, c[2]), norm(rest)};
        toIndex_ = inverse(toFrame_);
        const Mat3 rows = transpose(toIndex_);
        narrowestMm_ =
            1 / std::max({norm(rows.column[0]), norm(rows.column[1]), norm(rows.column[2])});
    }

    Vec3 fromIndex(const Vec3& index) const { return toFrame_ * index; }
    Vec3 toIndex(const Vec3& point) const { return toIndex_ * point; }

    /// The least distance between neighbouring planes of samples, mm.
    double narrowestMm() const { return narrowestMm_; }
    /// The side of a cube with the volume of a voxel, mm.
    double voxelMm() const { return voxelMm_; }

private:
    Mat3 toFrame_, toIndex_;
    double narrowestMm_, voxelMm_;
};

}  // namespace adaptiso::detail
