#pragma once

#include <itkImage.h>

#include <memory>
#include <new>
#include <string>

#include "adaptiso/Core/Volume.h"

/// Shared by the filters. ITK's headers are slow to compile: for few .cxx files.
namespace adaptiso::detail {

template <class T>
using ItkImage = itk::Image<T, 3>;

/// Samples as an ITK image, uncopied. ITK takes any direction with a determinant other than 0,
/// sheared and mirrored ones too. \pre they outlive it, and no filter writes to it
template <class T>
typename ItkImage<T>::Pointer asItkImage(const T* samples, const ImageGeometry& geometry) {
    auto image = ItkImage<T>::New();
    typename ItkImage<T>::PointType origin;
    typename ItkImage<T>::SpacingType spacing;
    typename ItkImage<T>::DirectionType direction;
    typename ItkImage<T>::SizeType size;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3& step = geometry.indexToPhysical.column[axis];
        size[axis] = static_cast<itk::SizeValueType>(geometry.size[axis]);
        origin[axis] = geometry.originMm[axis];
        spacing[axis] = norm(step);
        for (int row = 0; row < 3; ++row) direction(row, axis) = step[row] / norm(step);
    }
    image->SetRegions(size);
    image->SetOrigin(origin);
    image->SetSpacing(spacing);
    image->SetDirection(direction);
    image->GetPixelContainer()->SetImportPointer(
        const_cast<T*>(samples), static_cast<itk::SizeValueType>(geometry.voxelCount()), false);
    return image;
}

/// Calls `run`, which runs ITK's `name`.
/// \throws std::bad_alloc, InternalError for what else ITK throws
template <class Run>
void runItk(const std::string& name, const Run& run) {
    try {
        run();
    } catch (const itk::MemoryAllocationError&) {
        throw std::bad_alloc();
    } catch (const itk::ExceptionObject& error) {
        throw InternalError(name + ": " + error.GetDescription());
    }
}

}  // namespace adaptiso::detail
