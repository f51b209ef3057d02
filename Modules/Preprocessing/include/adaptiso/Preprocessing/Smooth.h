#pragma once

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Convolves a volume with a Gaussian that is round in space: the same standard deviation in mm in
/// every direction, whatever the voxels' shape.
///
/// In voxel indices such a Gaussian has the covariance C = sigma^2 M^-1 M^-T (M: index to mm).
/// Selling's reduction [Selling1874] [Fehrenbach2014] writes C as a sum of at most six w n n^T
/// with w > 0 and integer steps n, so that the Gaussian is a chain of 1-D ones along lines of
/// voxels, nothing interpolated. Where the axes are at right angles the steps are the axes; a
/// tilted gantry adds diagonals. The 1-D kernels are the discrete Gaussian [Lindeberg1990], whose
/// variance is w for any w, also far below a voxel; they end where 1e-5 of it is left. So the
/// variance in every direction is sigma^2, but for 1e-5 of it and 1e-6 squared steps. Each is
/// applied to float samples; samples beyond the border are those at the border.
///
/// Labels are blended like any other values.
/// \param sigmaMm  > 0, at most a quarter of the volume's shortest side
/// \return  float32, or float64 for samples that float32 can't hold
/// \throws  InvalidInput for another sigmaMm, or samples that are not finite (they would spread)
/// Cost: for each of the (usually three) steps, voxels times 10 sigma in steps; two float volumes.
Volume smoothVolume(const VolumeView& volume, double sigmaMm);

/// Nearly the same in a fifth of the time, for any sigmaMm: Deriche's recursive filter along the
/// axes, with the numbers of itk::SmoothingRecursiveGaussianImageFilter. It is a Gaussian to about
/// 1 %: its variance may be off by as much, and its tails swing around 0 by 1e-4 of what they come
/// from. For solids that are smoothed and cut at a level, not for measuring. Samples beyond the
/// border are those at the border.
/// \param sigmaMm  > 0; less than half a voxel is poorly approximated
/// \return  as smoothVolume
/// \throws  InvalidInput for another sigmaMm, axes that are not at right angles, fewer than 4
/// voxels
///          along one, or samples that are not finite
/// Cost: O(voxels), in parallel; the same bytes for any number of threads.
Volume smoothVolumeRecursively(const VolumeView& volume, double sigmaMm);

}  // namespace adaptiso
