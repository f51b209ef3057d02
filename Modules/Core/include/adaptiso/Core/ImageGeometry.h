#pragma once

#include <array>
#include <cstdint>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

using Index3 = std::array<std::int64_t, 3>;

/// Where the voxels of an image lie in space: voxel index (i, j, k) <-> physical point in LPS mm.
///
/// `indexToPhysical` holds direction times spacing; its columns are the steps of i, j and k in mm.
/// They need be neither orthogonal (gantry tilt is kept as shear) nor right-handed (mirrored
/// images have a negative determinant).
struct ImageGeometry {
    Index3 size{0, 0, 0};  ///< voxels along i, j, k
    Vec3 originMm;         ///< centre of voxel (0, 0, 0), LPS mm
    Mat3 indexToPhysical;  ///< mm per index step

    /// Number of voxels.
    std::int64_t voxelCount() const { return size[0] * size[1] * size[2]; }

    /// Physical point (LPS mm) of a continuous index.
    Vec3 toPhysical(const Vec3& index) const { return originMm + indexToPhysical * index; }

    /// Continuous index of a physical point (LPS mm).
    Vec3 toIndex(const Vec3& pointMm) const {
        return inverse(indexToPhysical) * (pointMm - originMm);
    }

    /// Length of the step along each axis, mm.
    Vec3 spacingMm() const {
        return {norm(indexToPhysical.column[0]), norm(indexToPhysical.column[1]),
                norm(indexToPhysical.column[2])};
    }

    double voxelVolumeMm3() const { return std::abs(determinant(indexToPhysical)); }

    /// Voxel indices that run mirrored in space (negative determinant): a triangle that is
    /// counter-clockwise in index space is clockwise in space.
    bool isMirrored() const { return determinant(indexToPhysical) < 0; }

    /// Takes a gradient per index step to one per mm: the inverse transpose of indexToPhysical,
    /// right for anisotropic, oblique and sheared images.
    Mat3 gradientToPhysical() const { return transpose(inverse(indexToPhysical)); }

    friend bool operator==(const ImageGeometry&, const ImageGeometry&) = default;
};

/// Distance between neighbouring planes of samples, the least of the three axes.
double leastPlaneDistanceMm(const ImageGeometry& geometry);

/// Refuses voxels that are needles or flakes, more than 10,000 times as long as thin: searches over
/// their length by their width would never end, and triangles would be lower than 1e-9 of their
/// length, which is degenerate. Scans have 300 at most (0.1 mm in planes 30 mm apart).
/// \throws InvalidInput
void requireNoNeedles(const ImageGeometry& geometry);

}  // namespace adaptiso
