#include "Common/ImageOptions.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "Common/CommonFrame.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"

namespace adaptiso {
namespace {

/// A series' number from 1, or a UID: digits and dots.
bool isSeries(const std::string& text) {
    const bool hasDigits = text.find_first_of("123456789") != std::string::npos &&
                           text.find_first_not_of("0123456789.") == std::string::npos &&
                           text.front() != '.';
    return hasDigits && text.size() <= 64;  // no UID is longer
}

}  // namespace

void declareReadOptions(CLI::App& app, ReadOptions& options, const std::string& heading) {
    const OptionGroup group(app, heading);
    group.value(
        "--series", "N|UID",
        [&options](const std::string& text) {
            if (!isSeries(text)) {
                throw UsageError("--series " + shown(text) +
                                 ": must be a number from the list of --list-series, from 1, "
                                 "or a series' UID");
            }
            options.series = text;
        },
        "Which series of a DICOM input with several: its number in the list that "
        "--list-series prints, or its UID");
    group.count("--volume-index", options.volumeIndex, 0, kAnyCount,
                "Which volume of a 4-D image (time points, echoes), counted from 0");
    group.count("--level", options.level, 0, kAnyCount,
                "Which resolution of an OME-Zarr or N5, 0 the finest (default)");
    group.count("--channel", options.channel, 0, kAnyCount,
                "Which channel of an OME-Zarr or N5 with several, counted from 0");
    group.count("--time", options.timePoint, 0, kAnyCount,
                "Which time point of an OME-Zarr or N5 with several, counted from 0");
    group.flag("--refuse-missing-chunks", options.refusesMissingChunks,
               "Refuse a Zarr in which chunks are missing; else the fill value stands for them, "
               "with a warning");
    group.flag("--resample-slices", options.resampleSlices,
               "Blend unevenly spaced DICOM slices linearly onto even steps, in place of "
               "refusing them");
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

CLI::Option* declareVolume(CLI::App& app, std::filesystem::path& volume, ReadOptions& options,
                           const std::string& description, const std::string& heading) {
    const OptionGroup group(app, heading);
    CLI::Option* const option = group.text("--volume", "IMG", volume, description);
    declareReadOptions(app, options, heading);
    for (const char* const name : {"--series", "--volume-index", "--level", "--channel", "--time",
                                   "--refuse-missing-chunks", "--resample-slices"}) {
        app.get_option(name)->needs(option);
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
