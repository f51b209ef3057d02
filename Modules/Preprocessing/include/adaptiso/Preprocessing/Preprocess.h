#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// Voxel indices first, first + 1, ... up to but not including `end`.
struct IndexRange {
    std::int64_t first = 0;
    std::optional<std::int64_t> end;  ///< default: the end of the axis

    friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

/// Ranges to keep along i, j and k.
using CropRanges = std::array<IndexRange, 3>;

/// The part of a volume within ranges of voxel indices. Every voxel keeps its place in space: the
/// origin moves to the first voxel kept, along the image's own axes, oblique or sheared.
///
/// \return  samples of the same type (itk::RegionOfInterestImageFilter)
/// \throws  InvalidInput unless 0 <= first, end <= size, and 2 voxels or more are left along every
///          axis (fewer are no volume)
/// Cost: a copy of what is kept.
Volume cropVolume(const VolumeView& volume, const CropRanges& ranges);

enum class Interpolation {
    Linear,   ///< between the eight voxels around: exact for values that change linearly
    BSpline,  ///< cubic B-spline through all voxels: smoother, may overshoot at edges
    Nearest   ///< the nearest voxel's value: for labels
};

/// "linear", "bspline", "nearest"
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

/// Samples a volume on isotropicGrid() with the numbers of itk::ResampleImageFilter.
///
/// Does not smooth: for steps larger than the voxels smooth first (half a step is
/// enough), or detail finer than the step turns into noise. Points of the grid that lie outside a
/// sheared image get its smallest value.
/// \return  Nearest: the same type; else float32, or float64 for samples that float32 can't hold
/// \throws  InvalidInput as isotropicGrid(); for samples that are not finite, unless Nearest; when
///          the result would not fit into this machine's memory
/// Cost: BSpline keeps coefficients in double.
Volume resampleVolume(const VolumeView& volume, double stepMm, Interpolation interpolation);

/// Steps to take before a volume is used, in this order.
struct PreprocessOptions {
    std::optional<CropRanges> crop{};
    std::optional<double> smoothSigmaMm{};
    std::optional<double> resampleMm{};  ///< side of the cubic voxels
    Interpolation interpolation = Interpolation::Linear;

    bool changesNothing() const { return !crop && !smoothSigmaMm && !resampleMm; }
    friend bool operator==(const PreprocessOptions&, const PreprocessOptions&) = default;
};

/// --crop, --smooth, --resample and --interpolation
const Options<PreprocessOptions>& preprocessOptions();

/// In the order of preprocessOptions().
enum class PreprocessStep { Crop, Smooth, Resample };

/// "smooth 50": the option that asks for a step, and its value.
std::string optionOf(PreprocessStep step, const PreprocessOptions& options);

/// A step that is impossible for the volume. The message gives the reason, without a function.
class PreprocessError : public InvalidInput {
public:
    PreprocessError(PreprocessStep step, const std::string& message)
        : InvalidInput(message), step_(step) {}

    PreprocessStep step() const { return step_; }

private:
    PreprocessStep step_;
};

struct Preprocessed {
    Volume volume;
    std::vector<Warning> warnings;  ///< one line each
};

/// Crops, then smooths, then resamples: cropVolume(), smoothVolume(), resampleVolume(). Smoothing
/// sees the image as cropped. Without options the volume comes back as it is, uncopied.
///
/// Warns where blending looks wrong (3 to 100 different whole numbers that fill regions are labels,
/// most likely), and of what resampling a sheared image adds around it.
/// \param volume  given up: its samples go as soon as they are not needed
/// \throws PreprocessError where one of the three throws InvalidInput
Preprocessed preprocess(Volume volume, const PreprocessOptions& options);

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
