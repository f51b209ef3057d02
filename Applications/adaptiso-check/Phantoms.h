#pragma once

#include <functional>
#include <string>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::checker::selftest {

/// A solid whose size is known on paper; its surface is one piece.
struct Solid {
    /// How deep a point (LPS mm) lies inside, mm: the exact distance to the surface, negative
    /// outside.
    std::function<double(const Vec3&)> depthMm;
    double volumeMm3 = 0, areaMm2 = 0;
    int genus = 0;
    Vec3 centreMm;                ///< LPS
    double smallestRadiusMm = 0;  ///< of its surface's curvature
};

/// \pre radiusMm > 0
Solid ball(const Vec3& centreMm, double radiusMm);
/// Ring about an axis along z. \pre majorRadiusMm > minorRadiusMm > 0
Solid ring(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm);

/// Turned about an axis that no voxel axis shares, the solid in the middle.
ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm, const Solid& solid);

/// Samples of distance, int16: kDistanceSurface on the solid's surface, kDistancePerMm more for
/// each mm inwards.
inline constexpr double kDistanceSurface = 1000, kDistancePerMm = 100;
Volume distanceScan(const Solid& solid, const ImageGeometry& geometry);

/// Two steel balls of this diameter (mm) in air as a CT sees them, int16: each sample is the mean
/// over its voxel, with noise of 20 HU; -1000 in air, 3000 in the balls. 0.5 mm voxels.
Volume bearingBalls(double diameterMm);
inline constexpr double kBallSurface = 1000;  ///< half of a voxel is ball

/// The image as an uncompressed NIfTI-1 file. \pre its samples are int16
std::string niftiFile(const VolumeView& scan);

}  // namespace adaptiso::checker::selftest
