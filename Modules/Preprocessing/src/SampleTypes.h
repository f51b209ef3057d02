#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// Blended samples of this type: float32 where it holds every value of `stored`, else float64.
PixelType blendedType(PixelType stored);

/// The samples as F, which must hold them: themselves if they are F already, else a copy. The
/// result lives as long as the view's samples do.
template <class F>
std::shared_ptr<const F> samplesAs(const VolumeView& volume);
extern template std::shared_ptr<const float> samplesAs(const VolumeView&);
extern template std::shared_ptr<const double> samplesAs(const VolumeView&);

/// Calls f(F{}) with the C++ type of blendedType().
template <class Function>
decltype(auto) withBlendedType(PixelType stored, Function&& f) {
    if (blendedType(stored) == PixelType::Float32) return f(float{});
    return f(double{});
}

/// \throws InvalidInput when a sample is NaN or infinite
void requireFinite(const VolumeView& volume);

/// A 1-D Gaussian along lines of voxels.
struct LatticeGaussian {
    Index3 step;      ///< from one voxel of a line to the next
    double variance;  ///< in steps squared, > 0
};

/// The 1-D Gaussians that together have the standard deviation sigmaMm in every direction in
/// space: the sum of variance * step * step^T is sigma^2 M^-1 M^-T.
///
/// Selling's reduction of a superbase of the lattice [Selling1874], as in [Fehrenbach2014]. Parts
/// of less than 1e-6 (a thousandth of a step wide) are left out: they come from the rounding of
/// directions.
/// \return at most six, the same for the same input
std::vector<LatticeGaussian> latticeGaussians(const ImageGeometry& geometry, double sigmaMm);

/// The discrete Gaussian e^-t I_n(t) for n = 0, 1, ..., r [Lindeberg1990], of variance t; r is the
/// first with less than 1e-5 of the variance beyond. Scaled so that all 2 r + 1 weights sum to 1.
std::vector<double> discreteGaussian(double variance);

}  // namespace adaptiso::detail
