#include "Common/ImageOptions.h"

#include <CLI/CLI.hpp>

#include "Common/CommonFrame.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"

namespace adaptiso {
void declareReadOptions(CLI::App& app, ReadOptions& options, const std::string& heading) {
    OptionGroup(app, heading).rows(readOptions(), options);
}

ReadVolume readImage(const std::filesystem::path& file, const ReadOptions& options) {
    try {
        return readVolume(file, options);
    } catch (const FileError&) {
        const std::string hint = surfaceHint(file);
        if (hint.empty()) throw;
        throw FileError(file.string() + ": " + hint);
    }
}

ReadVolume readOnlyImage(const std::filesystem::path& file) {
    try {
        return readImage(file, {});
    } catch (const ChoiceNeeded& choice) {
        const bool areVolumes = choice.among() == ChoiceNeeded::Among::Volumes;
        throw FileError(file.string() + ": holds " + std::to_string(choice.count()) +
                        (areVolumes ? " volumes" : " series") +
                        ", must hold one here; write the one that is meant to a file of its own");
    }
}

CLI::Option* declareVolume(CLI::App& app, std::filesystem::path& volume, ReadOptions& options,
                           const std::string& description, const std::string& heading) {
    const OptionGroup group(app, heading);
    CLI::Option* const option = group.text("--volume", "IMG", volume, description);
    declareReadOptions(app, options, heading);
    for (const auto& row : readOptions()) {
        app.get_option("--" + std::string(row.facts.name))->needs(option);
    }
    return option;
}

void declareImageOptions(CLI::App& app, ImageOptions& options, const std::string& heading) {
    const OptionGroup group(app, heading);
    declareReadOptions(app, options.read, heading);
    CLI::Option* const list = group.flag("--list-series", options.listsSeries,
                                         "List the series of a DICOM input, then exit");
    group
        .flag("--info", options.tellsInfo,
              "Print the image's geometry and value statistics, with thresholds by Otsu's "
              "method, then exit")
        ->excludes(list);
    group.flag("--show-phi", options.showsPhi,
               "With --list-series and --info: print UIDs, descriptions and file names too; "
               "they may identify the patient");
}

}  // namespace adaptiso
