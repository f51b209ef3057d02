#pragma once

#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso::detail {

/// Convolves every line along `axis` with Deriche's recursive approximation of a Gaussian of
/// standard deviation sigmaMm [Deriche1993], [Farneback2006]; samples beyond the border are those
/// at it. Works in double, in the order of itk::RecursiveGaussianImageFilter, whose numbers it
/// gives to the bit.
/// \param to  may be `from`  \pre 4 voxels or more along the axis
void smoothLines(const float* from, float* to, const ImageGeometry& geometry, int axis,
                 double sigmaMm);
void smoothLines(const double* from, float* to, const ImageGeometry& geometry, int axis,
                 double sigmaMm);

}  // namespace adaptiso::detail
