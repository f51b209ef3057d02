#include "Common/PreprocessingOptions.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

void declarePreprocessingOptions(CLI::App& app, PreprocessOptions& options,
                                 const std::string& heading) {
    OptionGroup(app, heading).rows(preprocessOptions(), options);
    app.get_option("--interpolation")->needs(app.get_option("--resample"));
}

Preprocessed preprocessImage(Volume volume, const PreprocessOptions& options,
                             const std::filesystem::path& file) {
    try {
        return preprocess(std::move(volume), options);
    } catch (const PreprocessError& error) {
        throw InvalidInput("--" + optionOf(error.step(), options) + ": " + error.what() + " (" +
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

}  // namespace adaptiso
