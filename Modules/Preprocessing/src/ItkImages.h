#pragma once

#include <itkImage.h>
#include <tbb/global_control.h>

#include <memory>
#include <new>
#include <string>

#include "adaptiso/Core/Volume.h"

/// What the filters share. ITK's headers are slow to compile: for few .cxx files.
namespace adaptiso::detail {

template <class T>
using ItkImage = itk::Image<T, 3>;

/// Gives an ITK image a place in space. ITK takes any direction with a determinant other than 0,
/// sheared and mirrored ones too.
template <class ImageOrFilter>
void placeLike(const ImageGeometry& geometry, ImageOrFilter set) {
    ItkImage<float>::PointType origin;
    ItkImage<float>::SpacingType spacing;
    ItkImage<float>::DirectionType direction;
    ItkImage<float>::SizeType size;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3& step = geometry.indexToPhysical.column[axis];
        size[axis] = static_cast<itk::SizeValueType>(geometry.size[axis]);
        origin[axis] = geometry.originMm[axis];
        spacing[axis] = norm(step);
        for (int row = 0; row < 3; ++row) direction(row, axis) = step[row] / norm(step);
    }
    set(size, origin, spacing, direction);
}

/// Samples as an ITK image, uncopied. \pre they outlive it, and no filter writes to it
template <class T>
typename ItkImage<T>::Pointer asItkImage(const T* samples, const ImageGeometry& geometry) {
    auto image = ItkImage<T>::New();
    placeLike(geometry, [&](const auto& size, const auto& origin, const auto& spacing,
                            const auto& direction) {
        image->SetRegions(size);
        image->SetOrigin(origin);
        image->SetSpacing(spacing);
        image->SetDirection(direction);
    });
    image->GetPixelContainer()->SetImportPointer(
        const_cast<T*>(samples), static_cast<itk::SizeValueType>(geometry.voxelCount()), false);
    return image;
}

/// An ITK image's samples as a volume of `geometry`, which knows its place more exactly.
template <class T>
Volume toVolume(const typename ItkImage<T>::Pointer& image, PixelType type,
                const ImageGeometry& geometry) {
    return Volume(VolumeView(static_cast<const void*>(image->GetBufferPointer()), type, geometry),
                  std::make_shared<typename ItkImage<T>::Pointer>(image));
}

/// Runs a filter in as many threads as the rest of the program.
/// \throws std::bad_alloc, InternalError for what else ITK throws
template <class Filter>
void runFilter(Filter& filter) {
    filter.SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
    try {
        filter.Update();
    } catch (const itk::MemoryAllocationError&) {
        throw std::bad_alloc();
    } catch (const itk::ExceptionObject& error) {
        throw InternalError(std::string(filter.GetNameOfClass()) + ": " + error.GetDescription());
    }
}

}  // namespace adaptiso::detail
