#include "adaptiso/Preprocessing/Preprocess.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "adaptiso/Preprocessing/Smooth.h"

namespace adaptiso {
namespace {

/// Different values in a volume of integers; `most` + 1 when there are more, or it holds floats.
std::size_t countDistinct(const VolumeView& volume, std::size_t most) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        if constexpr (std::is_integral_v<T>) {
            std::vector<T> values{view.samples[0]};
            T last = values[0];
            for (std::int64_t n = 1; n < view.geometry.voxelCount(); ++n) {
                if (view.samples[n] == last) continue;
                last = view.samples[n];
                const auto place = std::lower_bound(values.begin(), values.end(), last);
                if (place != values.end() && *place == last) continue;
                values.insert(place, last);
                if (values.size() > most) break;
            }
            return values.size();
        } else {
            return most + 1;
        }
    });
}

void warnOfBlendedLabels(const VolumeView& volume, const PreprocessOptions& options,
                         std::vector<Warning>& warnings) {
    constexpr std::size_t kFewest = 3, kMost = 100;  // two are a mask, which blends well
    const bool resamplesBlending =
        options.resampleMm && options.interpolation != Interpolation::Nearest;
    if (!options.smoothSigmaMm && !resamplesBlending) return;
    const std::size_t count = countDistinct(volume, kMost);
    if (count < kFewest || count > kMost) return;
    warnings.push_back(
        {"blended-labels",
         "the image holds " + std::to_string(count) +
             " different whole numbers only: if they are labels, blending them gives "
             "others in between; resample labels with nearest interpolation, unsmoothed"});
}

/// Some of the grid lies beyond the outermost voxels of the image, which is convex.
bool leavesImage(const ImageGeometry& grid, const ImageGeometry& image) {
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 index;
        for (int axis = 0; axis < 3; ++axis) {
            index[axis] = (corner >> axis & 1) != 0 ? static_cast<double>(grid.size[axis] - 1) : 0;
        }
        const Vec3 place = image.toIndex(grid.toPhysical(index));
        for (int axis = 0; axis < 3; ++axis) {
            const auto last = static_cast<double>(image.size[axis] - 1);
            if (place[axis] < -0.5 || place[axis] > last + 0.5) return true;
        }
    }
    return false;
}

/// What a step makes. \throws PreprocessError when it can't be done
template <class Work>
Volume take(PreprocessStep step, Work&& work) {
    try {
        return std::forward<Work>(work)();
    } catch (const InvalidInput& error) {
        throw PreprocessError(step, error.what());
    }
}

}  // namespace

Preprocessed preprocess(Volume volume, const PreprocessOptions& options) {
    std::vector<Warning> warnings;
    if (options.crop) {
        volume = take(PreprocessStep::Crop, [&] { return cropVolume(volume, *options.crop); });
    }
    warnOfBlendedLabels(volume, options, warnings);
    if (options.smoothSigmaMm) {
        volume = take(PreprocessStep::Smooth,
                      [&] { return smoothVolume(volume, *options.smoothSigmaMm); });
    }
    if (options.resampleMm) {
        const ImageGeometry before = volume.view().geometry();
        volume = take(PreprocessStep::Resample, [&] {
            return resampleVolume(volume, *options.resampleMm, options.interpolation);
        });
        if (leavesImage(volume.view().geometry(), before)) {
            warnings.push_back({"resample-filled",
                                "the image's axes are not at right angles; resampling made "
                                "them so, and filled "
                                "what lies around the image with its smallest value"});
        }
    }
    return {std::move(volume), std::move(warnings)};
}

}  // namespace adaptiso
