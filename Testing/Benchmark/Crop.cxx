#include "Crop.h"

#include <regex>
#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::benchmarks {

Crop parseCrop(const std::string& text) {
    static const std::regex kPattern(
        R"((\d{1,9}):(\d{1,9}),(\d{1,9}):(\d{1,9}),(\d{1,9}):(\d{1,9}))");
    std::smatch match;
    if (!std::regex_match(text, match, kPattern)) {
        throw InvalidInput("parseCrop: " + text + ": must be i0:i1,j0:j1,k0:k1");
    }
    Crop crop;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        crop.first[axis] = std::stoll(match[2 * axis + 1]);
        crop.last[axis] = std::stoll(match[2 * axis + 2]);
    }
    return crop;
}

Volume cropped(const VolumeView& volume, const Crop& crop) {
    ImageGeometry geometry = volume.geometry();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t first = crop.first[axis], last = crop.last[axis];
        if (first < 0 || first > last || last >= volume.geometry().size[axis]) {
            throw InvalidInput("cropped: samples " + std::to_string(first) + " to " +
                               std::to_string(last) + " of " +
                               std::to_string(volume.geometry().size[axis]) + " along axis " +
                               std::to_string(axis) + ", must be some of them");
        }
        geometry.size[axis] = last - first + 1;
    }
    geometry.originMm = volume.geometry().toPhysical({static_cast<double>(crop.first[0]),
                                                      static_cast<double>(crop.first[1]),
                                                      static_cast<double>(crop.first[2])});
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        std::vector<T> samples;
        samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
        for (std::int64_t k = crop.first[2]; k <= crop.last[2]; ++k) {
            for (std::int64_t j = crop.first[1]; j <= crop.last[1]; ++j) {
                const T* row = &view.at(crop.first[0], j, k);
                samples.insert(samples.end(), row, row + geometry.size[0]);
            }
        }
        return Volume::fromSamples(std::move(samples), geometry);
    });
}

}  // namespace adaptiso::benchmarks
