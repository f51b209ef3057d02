#include "adaptiso/Preprocessing/Preprocess.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "adaptiso/Core/Text.h"
#include "adaptiso/Preprocessing/LabelValues.h"

namespace adaptiso {

namespace {

void warnOfBlendedLabels(const VolumeView& volume, const PreprocessOptions& options,
                         std::vector<Warning>& warnings) {
    const bool resamplesBlending =
        options.resampleMm && options.interpolation != Interpolation::Nearest;
    if (!options.smoothSigmaMm && !resamplesBlending) return;
    const auto values = findLabelValues(volume);
    if (!values) return;
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

/// Runs a step. \throws PreprocessError if it is impossible
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

namespace {

/// The axes at right angles that are nearest to those of the image, i first.
std::array<Vec3, 3> rightAngledAxes(const Mat3& indexToPhysical) {
    std::array<Vec3, 3> axes;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 rest = normalized(indexToPhysical.column[axis]);
        for (int before = 0; before < axis; ++before) {
            rest = rest - dot(rest, axes[before]) * axes[before];
        }
        axes[axis] = normalized(rest);
    }
    return axes;
}

/// Half of what the voxels' centres span along `axis`, mm.
double halfSpanMm(const ImageGeometry& geometry, const Vec3& axis) {
    double span = 0;
    for (int a = 0; a < 3; ++a) {
        span += static_cast<double>(geometry.size[a] - 1) *
                std::abs(dot(geometry.indexToPhysical.column[a], axis));
    }
    return span / 2;
}

[[noreturn]] void refuse(double stepMm, const std::string& rule) {
    std::ostringstream message;
    message << "voxels of " << stepMm << " mm: " << rule;
    throw InvalidInput(message.str());
}

}  // namespace

namespace {

constexpr std::array<std::string_view, 3> kInterpolations{"linear", "bspline", "nearest"};
constexpr NumberRule kLength{.least = 0, .isAbove = true, .unit = "mm"};

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

/// Digits alone; no sign.
std::optional<std::int64_t> parseIndex(std::string_view text) {
    std::int64_t index = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, index);
    if (error != std::errc{} || end != last || index < 0) return std::nullopt;
    return index;
}

/// "10:90", "10:", ":90", ":"
std::optional<IndexRange> parseRange(std::string_view text) {
    const std::vector<std::string_view> bounds = split(text, ':');
    if (bounds.size() != 2) return std::nullopt;
    IndexRange range;
    if (!bounds[0].empty()) {
        const auto first = parseIndex(bounds[0]);
        if (!first) return std::nullopt;
        range.first = *first;
    }
    if (!bounds[1].empty()) {
        range.end = parseIndex(bounds[1]);
        if (!range.end) return std::nullopt;
    }
    return range;
}

/// "10:90,:,20:"
std::optional<CropRanges> parseCrop(std::string_view text) {
    const std::vector<std::string_view> parts = split(text, ',');
    CropRanges ranges;
    if (parts.size() != ranges.size()) return std::nullopt;
    for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
        const std::optional<IndexRange> range = parseRange(parts[axis]);
        if (!range) return std::nullopt;
        ranges[axis] = *range;
    }
    return ranges;
}

OptionValue cropValue(const PreprocessOptions& options, const OptionFacts&) {
    if (!options.crop) return {};
    std::string text;
    for (const auto& [first, end] : *options.crop) {
        text += text.empty() ? "" : ",";
        if (first != 0 || end) text += std::to_string(first);
        text += ":";
        if (end) text += std::to_string(*end);
    }
    return text;
}

void setCrop(PreprocessOptions& options, const OptionValue& value, const OptionFacts& facts) {
    options.crop.reset();
    const auto* const text = std::get_if<std::string>(&value);
    if (text == nullptr) return;
    options.crop = parseCrop(*text);
    if (!options.crop) {
        throw InvalidInput("crop " + *text + ": must be " + std::string(facts.textRule));
    }
}

}  // namespace

std::string_view toString(Interpolation interpolation) {
    return kInterpolations[static_cast<std::size_t>(interpolation)];
}

const Options<PreprocessOptions>& preprocessOptions() {
    static const Options<PreprocessOptions> kRows{
        {{.name = "crop",
          .key = "crop",
          .valueName = "I0:I1,J0:J1,K0:K1",
          .help = "First keep these voxels only: indices from 0, the end not included; a bound "
                  "left out is the image's border: 10:90,:,20:",
          .isUsable = [](std::string_view text) { return parseCrop(text).has_value(); },
          .textRule = "three ranges of voxel indices, as in 10:90,:,20:"},
         OptionKind::Text,
         true,
         cropValue,
         setCrop},
        option<&PreprocessOptions::smoothSigmaMm>(
            {.name = "smooth",
             .key = "smoothSigmaMm",
             .valueName = "SIGMA_MM",
             .help = "Then smooth with a Gaussian of this standard deviation, the same in every "
                     "direction in space",
             .rule = kLength}),
        option<&PreprocessOptions::resampleMm>({.name = "resample",
                                                .key = "resampleMm",
                                                .valueName = "MM",
                                                .help = "Then resample to cubic voxels with sides "
                                                        "of this length",
                                                .rule = kLength}),
        option<&PreprocessOptions::interpolation>(
            {.name = "interpolation",
             .key = "interpolation",
             .help = "How --resample finds values between voxels: linear, bspline (cubic), or "
                     "nearest (for labels)",
             .standard = "linear",
             .words = kInterpolations})};
    return kRows;
}

std::string optionOf(PreprocessStep step, const PreprocessOptions& options) {
    const auto& row = preprocessOptions()[static_cast<std::size_t>(step)];
    const OptionValue value = row.valueOf(options);
    const auto* const text = std::get_if<std::string>(&value);
    return std::string(row.facts.name) + " " +
           (text != nullptr ? *text : formatNumber(std::get<double>(value)));
}

ImageGeometry isotropicGrid(const ImageGeometry& geometry, double stepMm) {
    constexpr double kRounding = 1e-6;  // of a step: 100 mm in steps of 0.1 mm are 1000 of them
    if (!(stepMm > 0) || !std::isfinite(stepMm)) refuse(stepMm, "must be more than 0 mm");
    const std::array<Vec3, 3> axes = rightAngledAxes(geometry.indexToPhysical);
    const Vec3 last{static_cast<double>(geometry.size[0] - 1),
                    static_cast<double>(geometry.size[1] - 1),
                    static_cast<double>(geometry.size[2] - 1)};
    ImageGeometry grid;
    grid.originMm = geometry.toPhysical(0.5 * last);
    for (int axis = 0; axis < 3; ++axis) {
        const double steps = std::floor(2 * halfSpanMm(geometry, axes[axis]) / stepMm + kRounding);
        if (steps < 1) {
            refuse(stepMm,
                   std::string("the image is less than one of them wide along ") + "ijk"[axis]);
        }
        if (!(steps < 0x1p40)) refuse(stepMm, "are too many");  // whose product a double holds
        grid.size[axis] = static_cast<std::int64_t>(steps) + 1;
        grid.indexToPhysical.column[axis] = stepMm * axes[axis];
        grid.originMm = grid.originMm - (steps / 2 * stepMm) * axes[axis];
    }
    return grid;
}

}  // namespace adaptiso
