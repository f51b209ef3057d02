#include <itkBSplineInterpolateImageFunction.h>
#include <itkLinearInterpolateImageFunction.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <sstream>
#include <type_traits>

#include "ItkImages.h"
#include "SampleTypes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Preprocessing/Preprocess.h"

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

/// The voxels of `grid` in lines along i: a voxel's number, and where in the image it lies, as
/// itk::ResampleImageFilter works it out, in parallel.
/// \param  f  f(voxel, itk::ContinuousIndex)
template <class F>
void forEachVoxel(const ImageGeometry& geometry, const ImageGeometry& grid, const F& f) {
    const auto image = detail::asItkImage<float>(nullptr, geometry);
    const auto result = detail::asItkImage<float>(nullptr, grid);
    const std::int64_t length = grid.size[0];
    const auto placeOf = [&](std::int64_t i, std::int64_t line) {
        itk::ContinuousIndex<double, 3> place;
        itk::Point<double, 3> point;
        result->TransformIndexToPhysicalPoint({{i, line % grid.size[1], line / grid.size[1]}},
                                              point);
        image->TransformPhysicalPointToContinuousIndex(point, place);
        return place;
    };
    parallelForPieces(grid.size[1] * grid.size[2], 16, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t line = begin; line < end; ++line) {
            const auto first = placeOf(0, line), last = placeOf(length, line);
            for (std::int64_t i = 0; i < length; ++i) {
                const double part = static_cast<double>(i) / static_cast<double>(length);
                auto place = first;
                for (int axis = 0; axis < 3; ++axis) {
                    place[axis] += part * (last[axis] - first[axis]);
                }
                f(i + length * line, place);
            }
        }
    });
}

/// Value around the image: its smallest; 0 for one of NaN alone.
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

template <class Word>
Volume nearest(const VolumeView& volume, const ImageGeometry& grid, Word outside) {
    const TypedVolumeView<Word> view{static_cast<const Word*>(volume.samples()), volume.geometry()};
    const auto samples = std::make_shared_for_overwrite<Word[]>(grid.voxelCount());
    forEachVoxel(view.geometry, grid, [&](std::int64_t voxel, const auto& place) {
        itk::Index<3> index;
        index.CopyWithRound(place);
        bool isInside = true;
        for (int axis = 0; axis < 3; ++axis) {
            isInside = isInside && index[axis] >= 0 && index[axis] < view.geometry.size[axis];
        }
        samples[voxel] = isInside ? view.at(index[0], index[1], index[2]) : outside;
    });
    return Volume(VolumeView(samples.get(), volume.pixelType(), grid), samples);
}

template <class F>
Volume blend(const VolumeView& volume, const ImageGeometry& grid, Interpolation interpolation) {
    using Image = detail::ItkImage<F>;
    const std::shared_ptr<const F> stored = detail::samplesAs<F>(volume);
    typename itk::InterpolateImageFunction<Image, double>::Pointer interpolator;
    if (interpolation == Interpolation::Linear) {
        interpolator = itk::LinearInterpolateImageFunction<Image, double>::New();
    } else {
        const auto spline = itk::BSplineInterpolateImageFunction<Image, double, double>::New();
        spline->SetSplineOrder(3);
        interpolator = spline;
    }
    detail::runItk(interpolator->GetNameOfClass(), [&] {
        interpolator->SetInputImage(detail::asItkImage(stored.get(), volume.geometry()));
    });
    constexpr double kLeast = std::numeric_limits<F>::lowest();
    const F outside = smallest(stored.get(), volume.geometry().voxelCount());
    const auto samples = std::make_shared_for_overwrite<F[]>(grid.voxelCount());
    forEachVoxel(volume.geometry(), grid, [&](std::int64_t voxel, const auto& place) {
        samples[voxel] = interpolator->IsInsideBuffer(place)
                             ? static_cast<F>(std::clamp(
                                   interpolator->EvaluateAtContinuousIndex(place), kLeast, -kLeast))
                             : outside;
    });
    return Volume(VolumeView(samples.get(), grid), samples);
}

}  // namespace

Volume resampleVolume(const VolumeView& volume, double stepMm, Interpolation interpolation) {
    const ImageGeometry grid = isotropicGrid(volume.geometry(), stepMm);
    if (interpolation == Interpolation::Nearest) {
        requireMemory(grid, bytesPerPixel(volume.pixelType()), stepMm);
        return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
            // samples are moved, not looked at: any type of their size will do
            using Word = std::conditional_t<
                sizeof(T) == 1, std::uint8_t,
                std::conditional_t<
                    sizeof(T) == 2, std::uint16_t,
                    std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
            return nearest(volume, grid,
                           std::bit_cast<Word>(smallest(view.samples, view.geometry.voxelCount())));
        });
    }
    detail::requireFinite(volume);
    requireMemory(grid, bytesPerPixel(detail::blendedType(volume.pixelType())), stepMm);
    return detail::withBlendedType(
        volume.pixelType(), [&]<class F>(F) { return blend<F>(volume, grid, interpolation); });
}

}  // namespace adaptiso
