#include "adaptiso/Preprocessing/Resample.h"

#include <itkBSplineInterpolateImageFunction.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkNearestNeighborInterpolateImageFunction.h>
#include <itkResampleImageFilter.h>
#include <unistd.h>

#include <limits>
#include <sstream>

#include "ItkImages.h"
#include "SampleTypes.h"

namespace adaptiso {
namespace {

/// \throws InvalidInput when the result can't fit into memory, before anything is allocated
void requireMemory(const ImageGeometry& grid, std::size_t bytesPerSample, double stepMm) {
    double bytes = static_cast<double>(bytesPerSample);
    for (const std::int64_t extent : grid.size) bytes *= static_cast<double>(extent);
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes < memory) return;
    std::ostringstream message;
    message << "voxels of " << stepMm << " mm would be " << grid.size[0] << " x " << grid.size[1]
            << " x " << grid.size[2]
            << ", more than this machine's memory holds; take larger ones, or crop";
    throw InvalidInput(message.str());
}

template <class T>
using Interpolator = itk::InterpolateImageFunction<detail::ItkImage<T>, double>;

template <class F>
typename Interpolator<F>::Pointer makeBlender(Interpolation interpolation) {
    using Image = detail::ItkImage<F>;
    if (interpolation == Interpolation::Linear) {
        return itk::LinearInterpolateImageFunction<Image, double>::New().GetPointer();
    }
    const auto spline = itk::BSplineInterpolateImageFunction<Image, double, double>::New();
    spline->SetSplineOrder(3);
    return spline.GetPointer();
}

/// What lies around the image: its smallest value; 0 for one of NaN alone.
template <class T>
T smallest(const T* samples, std::int64_t count) {
    T result = std::numeric_limits<T>::max();
    bool found = false;
    for (std::int64_t n = 0; n < count; ++n) {
        if (!(samples[n] <= result)) continue;
        result = samples[n];
        found = true;
    }
    return found ? result : T{};
}

template <class T>
Volume sample(const T* samples, const ImageGeometry& geometry, const ImageGeometry& grid,
              const typename Interpolator<T>::Pointer& interpolator, PixelType type) {
    using Filter = itk::ResampleImageFilter<detail::ItkImage<T>, detail::ItkImage<T>, double>;
    const auto filter = Filter::New();
    filter->SetInput(detail::asItkImage(samples, geometry));
    filter->SetInterpolator(interpolator);
    filter->SetDefaultPixelValue(smallest(samples, geometry.voxelCount()));
    detail::placeLike(grid, [&](const auto& size, const auto& origin, const auto& spacing,
                                const auto& direction) {
        filter->SetSize(size);
        filter->SetOutputOrigin(origin);
        filter->SetOutputSpacing(spacing);
        filter->SetOutputDirection(direction);
    });
    detail::runFilter(*filter);
    return detail::toVolume<T>(filter->GetOutput(), type, grid);
}

}  // namespace

Volume resampleVolume(const VolumeView& volume, double stepMm, Interpolation interpolation) {
    const ImageGeometry grid = isotropicGrid(volume.geometry(), stepMm);
    if (interpolation == Interpolation::Nearest) {
        requireMemory(grid, bytesPerPixel(volume.pixelType()), stepMm);
        return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
            using Nearest =
                itk::NearestNeighborInterpolateImageFunction<detail::ItkImage<T>, double>;
            return sample<T>(view.samples, view.geometry, grid, Nearest::New().GetPointer(),
                             volume.pixelType());
        });
    }
    detail::requireFinite(volume);
    requireMemory(grid, bytesPerPixel(detail::blendedType(volume.pixelType())), stepMm);
    return detail::withBlendedType(volume.pixelType(), [&]<class F>(F) {
        const std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
        return sample<F>(samples.get(), volume.geometry(), grid, makeBlender<F>(interpolation),
                         pixelTypeOf<F>());
    });
}

}  // namespace adaptiso
