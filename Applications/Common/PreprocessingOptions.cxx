#include "Common/PreprocessingOptions.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <string_view>
#include <utility>
#include <vector>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

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

CropRanges parseCrop(const std::string& text) {
    const auto refuse = [&] {
        throw UsageError("--crop " + shown(text) +
                         ": must be three ranges of voxel indices, as in 10:90,:,20:");
    };
    const std::vector<std::string_view> parts = split(text, ',');
    CropRanges ranges;
    if (parts.size() != ranges.size()) refuse();
    for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
        const std::optional<IndexRange> range = parseRange(parts[axis]);
        if (!range) refuse();
        ranges[axis] = *range;
    }
    return ranges;
}

/// "10:90,:,20:", as --crop takes it.
std::string cropText(const CropRanges& ranges) {
    std::string text;
    for (const auto& [first, end] : ranges) {
        text += text.empty() ? "" : ",";
        if (first != 0 || end) text += std::to_string(first);
        text += ":";
        if (end) text += std::to_string(*end);
    }
    return text;
}

/// The option that asks for a step, with its value.
std::string optionOf(PreprocessStep step, const PreprocessOptions& options) {
    switch (step) {
        case PreprocessStep::Crop:
            return "--crop " + cropText(options.crop.value());
        case PreprocessStep::Smooth:
            return "--smooth " + formatNumber(options.smoothSigmaMm.value());
        case PreprocessStep::Resample:
            return "--resample " + formatNumber(options.resampleMm.value());
    }
    throw InternalError("optionOf: unknown step");
}

}  // namespace

void declarePreprocessingOptions(CLI::App& app, PreprocessOptions& options,
                                 const std::string& heading) {
    const OptionGroup group(app, heading);
    group.value(
        "--crop", "I0:I1,J0:J1,K0:K1",
        [&options](const std::string& text) { options.crop = parseCrop(text); },
        "First keep these voxels only: indices from 0, the end not included; a bound left out "
        "is the image's border: 10:90,:,20:");
    group.rows(filterOptions(), options);
    app.get_option("--interpolation")->needs(app.get_option("--resample"));
}

Preprocessed preprocessImage(Volume volume, const PreprocessOptions& options,
                             const std::filesystem::path& file) {
    try {
        return preprocess(std::move(volume), options);
    } catch (const PreprocessError& error) {
        throw InvalidInput(optionOf(error.step(), options) + ": " + error.what() + " (" +
                           file.string() + ")");
    }
}

std::string preprocessingText(const PreprocessOptions& options, const Index3& size) {
    std::string text;
    const auto add = [&](const std::string& step) { addPart(text, step); };
    if (options.crop) {
        std::string ranges;
        for (std::size_t axis = 0; axis < size.size(); ++axis) {
            const auto& [first, end] = (*options.crop)[axis];
            ranges += (axis == 0 ? "" : ",") + std::to_string(first) + ":" +
                      std::to_string(end.value_or(size[axis]));
        }
        add("crop " + ranges);
    }
    if (options.smoothSigmaMm) add("smooth " + formatNumber(*options.smoothSigmaMm) + " mm");
    if (options.resampleMm) {
        add("resample " + formatNumber(*options.resampleMm) + " mm (" +
            std::string(toString(options.interpolation)) + ")");
    }
    return text;
}

Json preprocessingJson(const PreprocessOptions& options, const Index3& size) {
    if (options.changesNothing()) return nullptr;
    Json crop = nullptr;
    if (options.crop) {
        crop = Json::array();
        for (std::size_t axis = 0; axis < size.size(); ++axis) {
            const auto& [first, end] = (*options.crop)[axis];
            crop.push_back(Json::array({first, end.value_or(size[axis])}));
        }
    }
    return {{"crop", crop},
            {"smoothSigmaMm", orNull(options.smoothSigmaMm)},
            {"resampleMm", orNull(options.resampleMm)},
            {"interpolation",
             options.resampleMm ? Json(toString(options.interpolation)) : Json(nullptr)}};
}

}  // namespace adaptiso
