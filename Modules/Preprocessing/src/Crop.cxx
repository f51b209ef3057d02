#include "adaptiso/Preprocessing/Crop.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>

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

}  // namespace

Volume cropVolume(const VolumeView& volume, const CropRanges& ranges) {
    const ImageGeometry part = croppedGeometry(volume.geometry(), ranges);
    const std::size_t bytes = bytesPerPixel(volume.pixelType());
    const Index3& size = volume.geometry().size;
    const auto* const from = static_cast<const std::byte*>(volume.samples());
    const auto kept = std::make_shared_for_overwrite<std::byte[]>(
        bytes * static_cast<std::size_t>(part.voxelCount()));
    std::byte* to = kept.get();
    for (std::int64_t k = 0; k < part.size[2]; ++k) {
        for (std::int64_t j = 0; j < part.size[1]; ++j) {
            const std::int64_t first =
                ranges[0].first + size[0] * (ranges[1].first + j + size[1] * (ranges[2].first + k));
            to = std::copy_n(from + bytes * static_cast<std::size_t>(first),
                             bytes * static_cast<std::size_t>(part.size[0]), to);
        }
    }
    return Volume(VolumeView(kept.get(), volume.pixelType(), part), kept);
}

}  // namespace adaptiso
