#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Preprocessing/Crop.h"
#include "adaptiso/Preprocessing/Resample.h"

namespace adaptiso {

/// Steps to take before a volume is used, in this order.
struct PreprocessOptions {
    std::optional<CropRanges> crop{};
    std::optional<double> smoothSigmaMm{};
    std::optional<double> resampleMm{};  ///< side of the cubic voxels
    Interpolation interpolation = Interpolation::Linear;

    bool changesNothing() const { return !crop && !smoothSigmaMm && !resampleMm; }
    friend bool operator==(const PreprocessOptions&, const PreprocessOptions&) = default;
};

enum class PreprocessStep { Crop, Smooth, Resample };

/// The volume can't take a step. The message says why, and names no function.
class PreprocessError : public InvalidInput {
public:
    PreprocessError(PreprocessStep step, const std::string& message)
        : InvalidInput(message), step_(step) {}

    PreprocessStep step() const { return step_; }

private:
    PreprocessStep step_;
};

struct Preprocessed {
    Volume volume;
    std::vector<Warning> warnings;  ///< one line each
};

/// Crops, then smooths, then resamples: cropVolume(), smoothVolume(), resampleVolume(). Smoothing
/// sees the image as cropped. Without options the volume comes back as it is, uncopied.
///
/// Warns where blending looks wrong (3 to 100 different whole numbers that fill regions are labels,
/// most likely), and of what resampling a sheared image adds around it.
/// \param volume  given up: its samples go as soon as they are not needed
/// \throws PreprocessError where one of the three throws InvalidInput
Preprocessed preprocess(Volume volume, const PreprocessOptions& options);

}  // namespace adaptiso
