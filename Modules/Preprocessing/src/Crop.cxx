#include "adaptiso/Preprocessing/Crop.h"

#include <itkRegionOfInterestImageFilter.h>

#include <string>

#include "ItkImages.h"

namespace adaptiso {
namespace {

/// \return  the geometry of what is kept
ImageGeometry croppedGeometry(const ImageGeometry& whole, const CropRanges& ranges) {
    ImageGeometry part = whole;
    Vec3 first;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t begin = ranges[axis].first;
        const std::int64_t end = ranges[axis].end.value_or(whole.size[axis]);
        const auto refuse = [&](const std::string& rule) {
            throw InvalidInput(std::to_string(begin) + ":" + std::to_string(end) + " along " +
                               "ijk"[axis] + ": " + rule);
        };
        if (begin < 0 || end > whole.size[axis]) {
            refuse("the image has voxels 0:" + std::to_string(whole.size[axis]));
        }
        if (end - begin < 2) refuse("must keep 2 voxels or more");
        part.size[axis] = end - begin;
        first[axis] = static_cast<double>(begin);
    }
    part.originMm = whole.toPhysical(first);
    return part;
}

/// \tparam Word  any type of the samples' size: they are moved, not looked at
template <class Word>
Volume cropAs(const VolumeView& volume, const CropRanges& ranges, const ImageGeometry& part) {
    const auto image =
        detail::asItkImage(static_cast<const Word*>(volume.samples()), volume.geometry());
    typename detail::ItkImage<Word>::RegionType region;
    for (int axis = 0; axis < 3; ++axis) {
        region.SetIndex(axis, ranges[axis].first);
        region.SetSize(axis, static_cast<itk::SizeValueType>(part.size[axis]));
    }
    using Filter = itk::RegionOfInterestImageFilter<detail::ItkImage<Word>, detail::ItkImage<Word>>;
    const auto filter = Filter::New();
    filter->SetInput(image);
    filter->SetRegionOfInterest(region);
    detail::runFilter(*filter);
    return detail::toVolume<Word>(filter->GetOutput(), volume.pixelType(), part);
}

}  // namespace

Volume cropVolume(const VolumeView& volume, const CropRanges& ranges) {
    const ImageGeometry part = croppedGeometry(volume.geometry(), ranges);
    switch (bytesPerPixel(volume.pixelType())) {
        case 1:
            return cropAs<std::uint8_t>(volume, ranges, part);
        case 2:
            return cropAs<std::uint16_t>(volume, ranges, part);
        case 4:
            return cropAs<std::uint32_t>(volume, ranges, part);
        default:
            return cropAs<std::uint64_t>(volume, ranges, part);
    }
}

}  // namespace adaptiso
