#include <string>
#include <system_error>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso::bids {
namespace {

namespace fs = std::filesystem;

void declareArguments(CLI::App& app, BidsOptions& options) {
    const OptionGroup arguments(app);
    required(
        arguments.text("BIDS_DIR", "", options.dataset, "The dataset; nothing is written to it"));
    required(arguments.text("OUT_DIR", "", options.output,
                            "The dataset of derivatives to write; jobs of several participants may "
                            "share it, each writes below its own sub-*"));
    required(arguments.value(
        "LEVEL", "",
        [&options](const std::string& text) {
            options.level = parseChoice("LEVEL", text, {"participant", "group"}) == 0
                                ? BidsLevel::Participant
                                : BidsLevel::Group;
        },
        "participant: make what is not there yet; group: a table, a page, who is missing"));
}

void declareWhom(CLI::App& app, BidsOptions& options) {
    const OptionGroup group(app, "Participants");
    group.text("--participant-label,--participant_label", "LABEL...", options.participants,
               "Take these participants only: 01 or sub-01, one or several");
    group.text("--session-label,--session_label", "LABEL...", options.sessions,
               "Take these sessions only: 1 or ses-1, one or several");
    group.flag("--skip-bids-validation,--skip_bids_validation", options.skipsValidation,
               "Do not check the names in BIDS_DIR");
}

void declareWhat(CLI::App& app, BidsOptions& options) {
    const OptionGroup group(app, "Results to make (participant level) or to list (group level)");
    const auto addProduct = [&](const std::string& product, const char* help,
                                const char* optionsHelp) {
        group.flag(
            "--" + product, [&options, product] { options.wanted[product]; }, help);
        group.text("--" + product + "-options", "LIST", options.lists[product], optionsHelp);
    };
    group.text("--surfaces", "LIST", options.lists["surfaces"],
               "Isosurfaces of every T1w image: options of adaptiso-mesh without dashes, with "
               "commas between them, iso=100,iso=120,largest; format=stl names the files' "
               "extension (default, unless --bem or --labels is given: iso=auto)");
    addProduct("bem", "A head model of every T1w image, by adaptiso-bem",
               "Options of adaptiso-bem: vertices=642,meg,brain-mask=masks/{name}.nii.gz");
    addProduct("labels", "Surfaces of the regions of every label map (*_dseg), by adaptiso-labels",
               "Options of adaptiso-labels: max-error=0.3,format=stl");
    group.text("--segmentations", "DIR", options.segmentations,
               "With --labels: the dataset of derivatives that holds the label maps (default: "
               "BIDS_DIR)");
    addProduct("check",
               "Check the isosurfaces by adaptiso-check; the other programs check their own "
               "results",
               "Options of adaptiso-check: profile=view");
    group.flag(
        "--no-pictures", [&options] { options.makesPictures = false; },
        "Make no pictures for the page (2 MB a surface)");
}

void declareRunning(CLI::App& app, BidsOptions& options) {
    const OptionGroup group(app, "Group level");
    group.number("--outlier", "Z", options.outliers.limit, {.least = 0, .isAbove = true},
                 "Mark values farther than Z robust standard deviations (1.4826 times the median "
                 "distance from the median) from the cohort's median (default: 3.5)");
    group.number("--outlier-percent", "P", options.outliers.leastPercent, {.least = 0, .most = 100},
                 "Do not mark values within P per cent of the median (default: 1)");
    OptionGroup(app, "Running")
        .count("--jobs", options.jobs, 1, 1024,
               "Participant level: work on N scans at a time (default: 1)");
    declareCommonOptions(app, options.common, "its result is then not written");
}

/// "iso=100,largest" of "--iso=100,--largest".
std::string withoutDashes(std::string list) {
    list.insert(0, ",");
    for (std::size_t at = 0; (at = list.find(",--", at)) != std::string::npos;) {
        list.erase(at + 1, 2);
    }
    return list.substr(1);
}

void checkCombinations(BidsOptions& options) {
    const auto require = [](bool isGood, const std::string& message) {
        if (!isGood) throw UsageError(message);
    };
    const bool isGroup = options.level == BidsLevel::Group;
    for (const auto& [product, list] : options.lists) {
        if (list.empty()) continue;
        require(product == "surfaces" || options.makes(product),
                "--" + product + "-options: needs --" + product);
        options.wanted[product] = withoutDashes(list);
    }
    require(options.segmentations.empty() || options.makes("labels"),
            "--segmentations: needs --labels");
    // the group level takes the participant level's options
    if (!options.namesProducts() && !isGroup) options.wanted["surfaces"] = "iso=auto";
    require(!options.makes("check") || options.makes("surfaces") || isGroup,
            "--check: needs --surfaces");
    require(!isGroup || !options.jobs, "--jobs: is for the participant level");
    std::error_code error;
    require(!fs::equivalent(options.dataset, options.output, error),
            "OUT_DIR " + options.output.string() +
                ": is BIDS_DIR; name a folder of its own, such as BIDS_DIR/derivatives/adaptiso");
    require(options.segmentations.empty() ||
                !fs::equivalent(options.segmentations, options.output, error),
            "OUT_DIR " + options.output.string() +
                ": is the folder of --segmentations; name a folder of its own");
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-bids study study/derivatives/adaptiso participant --participant-label 01
      one participant: an isosurface at Otsu's value
  adaptiso-bids study out participant --surfaces iso=90,largest --bem --jobs 4
  adaptiso-bids study out participant --labels --segmentations study/derivatives/seg
  adaptiso-bids study out group
      by the options of the participant level: quality.tsv, summary.html, who is
      missing and why

Skips results already made from the same inputs (by checksum), options and
version. A participant may be run again at any time, by several at once too.

Exit codes: 0 done, 1 a scan or a participant failed, or (group) is missing,
2 wrong usage, 3 bad input (or no memory or disk left, or a run was killed: try
again), 4 internal error.)";

Program bidsProgram() {
    return {"adaptiso-bids",
            "Makes surfaces and head models of a BIDS dataset, as a BIDS App: one participant a "
            "job, then the group.",
            kFooter};
}

void declareBidsOptions(CLI::App& app, BidsOptions& options) {
    declareArguments(app, options);
    declareWhom(app, options);
    declareWhat(app, options);
    declareRunning(app, options);
    afterParsing(app, [&options] { checkCombinations(options); });
}

}  // namespace
}  // namespace adaptiso::bids

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::bids::bidsProgram(),
                            adaptiso::bids::declareBidsOptions, adaptiso::bids::runBids);
}
