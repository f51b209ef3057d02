#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <cmath>
#include <sstream>

#include "ItkImages.h"
#include "SampleTypes.h"
#include "adaptiso/Preprocessing/Smooth.h"

namespace adaptiso {
namespace {

void requireUsable(const ImageGeometry& geometry, double sigmaMm) {
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
Volume smoothAs(const VolumeView& volume, double sigmaMm) {
    const std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
    using Image = detail::ItkImage<F>;
    const auto filter = itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
    filter->SetInput(detail::asItkImage(samples.get(), volume.geometry()));
    filter->SetSigma(sigmaMm);
    detail::runFilter(*filter);
    return detail::toVolume<F>(filter->GetOutput(), pixelTypeOf<F>(), volume.geometry());
}

}  // namespace

Volume smoothVolumeRecursively(const VolumeView& volume, double sigmaMm) {
    requireUsable(volume.geometry(), sigmaMm);
    detail::requireFinite(volume);
    return detail::withBlendedType(volume.pixelType(),
                                   [&]<class F>(F) { return smoothAs<F>(volume, sigmaMm); });
}

}  // namespace adaptiso
