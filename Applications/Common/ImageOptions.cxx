#include "Common/ImageOptions.h"

#include "Common/Numbers.h"
#include "Common/RunApp.h"

namespace adaptiso {

void declareReadOptions(CLI::App& app, ReadOptions& options, const std::string& group) {
    options.mapFiles = true;  // runApp() answers a disk that fails
    app.add_option("--series", options.series,
                   "Which series of a DICOM input with several: its number in the list that "
                   "--list-series prints, or its UID")
        ->type_name("N|UID")
        ->group(group);
    app.add_option_function<std::string>(
           "--volume-index",
           [&options](const std::string& text) {
               std::int64_t index = -1;
               if (!CLI::detail::lexical_cast(text, index) || index < 0) {
                   throw UsageError("--volume-index " + text + ": must be a whole number from 0");
               }
               options.volumeIndex = index;
           },
           "Which volume of a 4-D image (time points, echoes), counted from 0")
        ->type_name("N")
        ->group(group);
    app.add_flag("--resample-slices", options.resampleSlices,
                 "Blend unevenly spaced DICOM slices linearly onto even steps, in place of "
                 "refusing them")
        ->group(group);
}

CLI::Option* declareVolume(CLI::App& app, std::filesystem::path& volume, ReadOptions& options,
                           const std::string& description, const std::string& group) {
    CLI::Option* const option =
        app.add_option("--volume", volume, description)->type_name("IMG")->group(group);
    declareReadOptions(app, options, group);
    for (const char* const name : {"--series", "--volume-index", "--resample-slices"}) {
        app.get_option(name)->needs(option);
    }
    return option;
}

void declareImageOptions(CLI::App& app, ImageOptions& options, const std::string& group) {
    declareReadOptions(app, options.read, group);
    CLI::Option* const list =
        app.add_flag("--list-series", options.listsSeries,
                     "List the series that a DICOM input holds, and do nothing else")
            ->group(group);
    app.add_flag("--info", options.tellsInfo,
                 "Tell the image's geometry and values, with thresholds by Otsu's method, and do "
                 "nothing else; an image that would be refused is refused")
        ->excludes(list)
        ->group(group);
    app.add_flag("--show-phi", options.showsPhi,
                 "With --list-series and --info: tell UIDs, descriptions and files' names too; "
                 "they may identify the patient")
        ->group(group);
}

}  // namespace adaptiso
