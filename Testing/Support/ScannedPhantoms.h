#pragma once

#include <string>

#include "Support/AnalyticVolumes.h"

namespace adaptiso::testing {

/// Samples of distance, int16: kDistanceSurface on the solid's surface, kDistancePerMm more for
/// each mm inwards.
inline constexpr double kDistanceSurface = 1000, kDistancePerMm = 100;
Volume distanceScan(const Shape& solid, const ImageGeometry& geometry);

/// Two steel balls of this diameter (mm) in air as a CT sees them, int16: each sample is the mean
/// over its voxel, with noise of 20 HU; -1000 in air, 3000 in the balls. 0.5 mm voxels.
Volume bearingBalls(double diameterMm);
inline constexpr double kBallSurface = 1000;  ///< half of a voxel is ball

/// The image as an uncompressed NIfTI-1 file. \pre its samples are int16
std::string niftiFile(const VolumeView& scan);

}  // namespace adaptiso::testing
