#include "Common/ImageOptions.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "Common/InputKind.h"
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

void declareReadOptions(CLI::App& app, ReadOptions& options, const std::string& group) {
    app.add_option_function<std::string>(
           "--series",
           [&options](const std::string& text) {
               if (!isSeries(text)) {
                   throw UsageError("--series " + shown(text) +
                                    ": must be a number from the list of --list-series, from 1, "
                                    "or a series' UID");
               }
               options.series = text;
           },
           "Which series of a DICOM input with several: its number in the list that "
           "--list-series prints, or its UID")
        ->type_name("N|UID")
        ->group(group);
    addCount(app, "--volume-index", options.volumeIndex, 0, kAnyCount,
             "Which volume of a 4-D image (time points, echoes), counted from 0")
        ->group(group);
    addCount(app, "--level", options.level, 0, kAnyCount,
             "Which resolution of an OME-Zarr or N5, 0 the finest (default)")
        ->group(group);
    addCount(app, "--channel", options.channel, 0, kAnyCount,
             "Which channel of an OME-Zarr or N5 with several, counted from 0")
        ->group(group);
    addCount(app, "--time", options.timePoint, 0, kAnyCount,
             "Which time point of an OME-Zarr or N5 with several, counted from 0")
        ->group(group);
    app.add_flag("--refuse-missing-chunks", options.refusesMissingChunks,
                 "Refuse a Zarr in which chunks are missing; else the fill value stands for them, "
                 "with a warning")
        ->group(group);
    app.add_flag("--resample-slices", options.resampleSlices,
                 "Blend unevenly spaced DICOM slices linearly onto even steps, in place of "
                 "refusing them")
        ->group(group);
}

ReadVolume readImage(const std::filesystem::path& file, const ReadOptions& options) {
    try {
        ReadVolume read = readVolume(file, options);
        if (options.series && read.format != "DICOM") {
            throw InvalidInput("--series " + *options.series + ": " + file.string() + " is " +
                               read.format + ", which has no series; leave --series out");
        }
        const bool asksForZarr =
            options.level || options.channel || options.timePoint || options.refusesMissingChunks;
        if (asksForZarr && read.format.find("Zarr") == std::string::npos) {
            throw InvalidInput(
                "--level, --channel, --time, --refuse-missing-chunks: " + file.string() + " is " +
                read.format + ", and these are for Zarr; leave them out");
        }
        return read;
    } catch (const FileError&) {
        const std::string hint = surfaceHint(file);
        if (hint.empty()) throw;
        throw FileError(file.string() + ": " + hint);
    }
}

CLI::Option* declareVolume(CLI::App& app, std::filesystem::path& volume, ReadOptions& options,
                           const std::string& description, const std::string& group) {
    CLI::Option* const option =
        app.add_option("--volume", volume, description)->type_name("IMG")->group(group);
    declareReadOptions(app, options, group);
    for (const char* const name : {"--series", "--volume-index", "--level", "--channel", "--time",
                                   "--refuse-missing-chunks", "--resample-slices"}) {
        app.get_option(name)->needs(option);
    }
    return option;
}

void declareImageOptions(CLI::App& app, ImageOptions& options, const std::string& group) {
    declareReadOptions(app, options.read, group);
    CLI::Option* const list = app.add_flag("--list-series", options.listsSeries,
                                           "List the series of a DICOM input, then exit")
                                  ->group(group);
    app.add_flag("--info", options.tellsInfo,
                 "Print the image's geometry and value statistics, with thresholds by Otsu's "
                 "method, then exit")
        ->excludes(list)
        ->group(group);
    app.add_flag("--show-phi", options.showsPhi,
                 "With --list-series and --info: print UIDs, descriptions and file names too; "
                 "they may identify the patient")
        ->group(group);
}

}  // namespace adaptiso
