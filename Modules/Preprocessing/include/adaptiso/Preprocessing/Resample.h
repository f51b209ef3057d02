#pragma once

#include <string_view>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

enum class Interpolation {
    Nearest,  ///< the nearest voxel's value: for labels
    Linear,   ///< between the eight voxels around: exact for values that change linearly
    BSpline   ///< cubic B-spline through all voxels: smoother, may overshoot at edges
};

/// "nearest", "linear", "bspline"
std::string_view toString(Interpolation interpolation);

/// The grid of cubic voxels that resampleVolume() samples.
///
/// Its axes are those of `geometry` where they are at right angles; a sheared image's are made so:
/// i stays, j and k turn as little as Gram-Schmidt does, and mirrored stays mirrored. The grid's
/// middle is the image's. At right angles it holds as many steps as fit between the first and the
/// last voxel's centres, so that nothing is extrapolated and less than half a step is lost at each
/// side. Of a sheared image it holds all.
/// \throws InvalidInput unless 0 < stepMm < infinity, and 2 steps or more fit along every axis
ImageGeometry isotropicGrid(const ImageGeometry& geometry, double stepMm);

/// Samples a volume on isotropicGrid() (itk::ResampleImageFilter).
///
/// Nothing is smoothed before: for steps larger than the voxels smooth first (half a step is
/// enough), or detail finer than the step turns into noise. Points of the grid that lie outside a
/// sheared image get its smallest value.
/// \return  Nearest: the same type; else float32, or float64 for samples that float32 can't hold
/// \throws  InvalidInput as isotropicGrid(); for samples that are not finite, unless Nearest; when
///          the result would not fit into this machine's memory
/// Cost: BSpline keeps coefficients in double.
Volume resampleVolume(const VolumeView& volume, double stepMm, Interpolation interpolation);

}  // namespace adaptiso
