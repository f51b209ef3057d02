#include "adaptiso/Preprocessing/Preprocess.h"

#include <algorithm>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>

#include "adaptiso/Preprocessing/Smooth.h"

namespace adaptiso {
namespace {

struct DistinctValues {
    std::size_t count = 0;
    /// Voxels in a row along i that hold the same value, on the mean, but for the commonest value.
    /// Labels fill regions (5 to 50 in atlases); grey values change from voxel to voxel (1.0 to 1.5
    /// in T1 scans, however few they are).
    double meanRun = 0;
};

/// The values of a volume of integers; empty when there are more than `most`, or it holds floats.
std::optional<DistinctValues> distinctValues(const VolumeView& volume, std::size_t most) {
    struct Tally {
        double voxels = 0, runs = 0;
    };
    return dispatchPixelType(
        volume, [&]<class T>(const TypedVolumeView<T>& view) -> std::optional<DistinctValues> {
            if constexpr (std::is_floating_point_v<T>) return std::nullopt;
            std::map<T, Tally> tallies;
            const std::int64_t row = view.geometry.size[0];
            Tally* tally = nullptr;
            for (std::int64_t n = 0; n < view.geometry.voxelCount(); ++n) {
                if (n % row == 0 || view.samples[n] != view.samples[n - 1]) {
                    tally = &tallies[view.samples[n]];
                    if (tallies.size() > most) return std::nullopt;
                    ++tally->runs;
                }
                ++tally->voxels;
            }
            Tally sum, commonest;
            for (const auto& [value, one] : tallies) {
                sum = {sum.voxels + one.voxels, sum.runs + one.runs};
                if (one.voxels > commonest.voxels) commonest = one;
            }
            const double runs = std::max(sum.runs - commonest.runs, 1.0);
            return DistinctValues{tallies.size(), (sum.voxels - commonest.voxels) / runs};
        });
}

void warnOfBlendedLabels(const VolumeView& volume, const PreprocessOptions& options,
                         std::vector<Warning>& warnings) {
    constexpr std::size_t kFewest = 3, kMost = 100;  // two are a mask, which blends well
    constexpr double kShortestRun = 2;
    const bool resamplesBlending =
        options.resampleMm && options.interpolation != Interpolation::Nearest;
    if (!options.smoothSigmaMm && !resamplesBlending) return;
    const auto values = distinctValues(volume, kMost);
    if (!values || values->count < kFewest || values->meanRun < kShortestRun) return;
    warnings.push_back(
        {"blended-labels",
         "the image holds " + std::to_string(values->count) +
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
