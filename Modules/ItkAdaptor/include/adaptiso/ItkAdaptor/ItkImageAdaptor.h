#pragma once

#include <itkImage.h>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/NativePixelType.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Views an existing ITK image as a volume, without copying: its buffered region, its pixels, and
/// its geometry (direction times spacing; both are LPS mm).
///
/// \param image  must outlive the view, and its buffer must not be reallocated meanwhile.
/// \throws InvalidInput when the image holds no pixels, or its axes span no volume.
template <class T>
VolumeView viewItkImage(const itk::Image<T, 3>& image) {
    const auto& region = image.GetBufferedRegion();
    if (region.GetNumberOfPixels() == 0 || image.GetBufferPointer() == nullptr) {
        throw InvalidInput("viewItkImage: the image holds no pixels; update its filter first");
    }
    ImageGeometry geometry;
    typename itk::Image<T, 3>::PointType origin;
    image.TransformIndexToPhysicalPoint(region.GetIndex(), origin);
    for (int axis = 0; axis < 3; ++axis) {
        geometry.size[axis] = static_cast<std::int64_t>(region.GetSize(axis));
        geometry.originMm[axis] = origin[axis];
        for (int row = 0; row < 3; ++row) {
            geometry.indexToPhysical.column[axis][row] =
                image.GetDirection()(row, axis) * image.GetSpacing()[axis];
        }
    }
    return VolumeView(static_cast<const void*>(image.GetBufferPointer()), nativePixelType<T>(),
                      geometry);
}

}  // namespace adaptiso
