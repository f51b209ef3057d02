#include "adaptiso/Preprocessing/Smooth.h"

#include <itkNeighborhood.h>
#include <itkNeighborhoodOperatorImageFilter.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "ItkImages.h"
#include "LatticeGaussian.h"
#include "SampleTypes.h"

namespace adaptiso {
namespace {

using Operator = itk::Neighborhood<double, 3>;

void requireUsableSigma(const ImageGeometry& geometry, double sigmaMm) {
    const Vec3 spacing = geometry.spacingMm();
    double shortestMm = static_cast<double>(geometry.size[0]) * spacing[0];
    for (int axis = 1; axis < 3; ++axis) {
        shortestMm = std::min(shortestMm, static_cast<double>(geometry.size[axis]) * spacing[axis]);
    }
    if (sigmaMm > 0 && sigmaMm <= shortestMm / 4) return;
    std::ostringstream message;
    message << "a standard deviation of " << sigmaMm
            << " mm must be more than 0 and at most a quarter of the image's shortest side, "
            << shortestMm << " mm";
    throw InvalidInput(message.str());
}

/// The Gaussian's weights on its line through a box of voxels.
Operator toOperator(const detail::LatticeGaussian& gaussian) {
    const std::vector<double> weights = detail::discreteGaussian(gaussian.variance);
    const auto reach = static_cast<std::int64_t>(weights.size()) - 1;
    Operator box;
    Operator::RadiusType radius;
    for (int axis = 0; axis < 3; ++axis) {
        radius[axis] = static_cast<itk::SizeValueType>(reach * std::abs(gaussian.step[axis]));
    }
    box.SetRadius(radius);
    std::fill(box.Begin(), box.End(), 0.0);
    for (std::int64_t n = -reach; n <= reach; ++n) {
        Operator::OffsetType offset;
        for (int axis = 0; axis < 3; ++axis) offset[axis] = n * gaussian.step[axis];
        box[offset] = weights[static_cast<std::size_t>(std::abs(n))];
    }
    return box;
}

template <class F>
Volume smoothAs(const VolumeView& volume, const std::vector<detail::LatticeGaussian>& gaussians) {
    std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
    typename detail::ItkImage<F>::Pointer image =
        detail::asItkImage(samples.get(), volume.geometry());
    using Filter =
        itk::NeighborhoodOperatorImageFilter<detail::ItkImage<F>, detail::ItkImage<F>, double>;
    for (const detail::LatticeGaussian& gaussian : gaussians) {
        const auto filter = Filter::New();
        filter->SetInput(image);
        filter->SetOperator(toOperator(gaussian));
        detail::runFilter(*filter);
        image = filter->GetOutput();
        image->DisconnectPipeline();  // so that the image before goes
        samples.reset();
    }
    return detail::toVolume<F>(image, pixelTypeOf<F>(), volume.geometry());
}

void requireRightAngles(const ImageGeometry& geometry, double sigmaMm) {
    std::ostringstream message;
    if (!(sigmaMm > 0)) message << "a standard deviation of " << sigmaMm << " mm must be above 0";
    const auto& axes = geometry.indexToPhysical.column;
    for (int a = 0; a < 3; ++a) {
        const Vec3 &one = axes[a], &other = axes[(a + 1) % 3];
        if (std::abs(dot(one, other)) > 1e-3 * norm(one) * norm(other)) {
            message << "axes must be at right angles";
        }
        if (geometry.size[a] < 4) message << "4 voxels or more are needed along every axis";
    }
    if (!message.str().empty()) throw InvalidInput("smoothVolumeRecursively: " + message.str());
}

template <class F>
Volume smoothRecursivelyAs(const VolumeView& volume, double sigmaMm) {
    const std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
    using Image = detail::ItkImage<F>;
    const auto filter = itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
    filter->SetInput(detail::asItkImage(samples.get(), volume.geometry()));
    filter->SetSigma(sigmaMm);
    detail::runFilter(*filter);
    return detail::toVolume<F>(filter->GetOutput(), pixelTypeOf<F>(), volume.geometry());
}

}  // namespace

Volume smoothVolume(const VolumeView& volume, double sigmaMm) {
    requireUsableSigma(volume.geometry(), sigmaMm);
    detail::requireFinite(volume);
    auto gaussians = detail::latticeGaussians(volume.geometry(), sigmaMm);
    if (gaussians.empty()) gaussians.push_back({{1, 0, 0}, 0});  // too narrow to show: a copy
    return detail::withBlendedType(volume.pixelType(),
                                   [&]<class F>(F) { return smoothAs<F>(volume, gaussians); });
}

Volume smoothVolumeRecursively(const VolumeView& volume, double sigmaMm) {
    requireRightAngles(volume.geometry(), sigmaMm);
    detail::requireFinite(volume);
    return detail::withBlendedType(
        volume.pixelType(), [&]<class F>(F) { return smoothRecursivelyAs<F>(volume, sigmaMm); });
}

}  // namespace adaptiso
