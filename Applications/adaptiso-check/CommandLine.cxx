#include "CommandLine.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/PreprocessingOptions.h"
#include "Common/UsageWords.h"

namespace adaptiso {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kPreprocessing = "Preprocessing of the volume for --iso (in this order)";
constexpr const char* kRequired = "What is required (exit code 1 when it does not hold)";
constexpr const char* kOutput = "Output";

void declareInput(CLI::App& app, CheckOptions& options) {
    app.add_option("FILE", options.files,
                   "Triangle surfaces, in any format adaptiso-mesh writes, however broken")
        ->type_name("");
    app.add_flag("--nested", options.isNested,
                 "The files are the surfaces of one head, from inside to outside (INNER MIDDLE "
                 "OUTER): check how they lie in each other too")
        ->group(kInput);
    declareInputCoordinates(app, options.inputCoordinates,
                            "all surfaces; given once for each file, that of each")
        ->group(kInput);
    declareVolume(app, options.volume, options.read,
                  "The image that the surfaces were made from; gives a place to tkRAS and voxel "
                  "coordinates",
                  kInput);
    app.add_option_function<std::string>(
           "--iso",
           [&options](const std::string& text) {
               options.isovalue = parseNumber("--iso", text, {});
           },
           "Measure how far the surfaces lie from the volume's isosurface at this value")
        ->type_name("V")
        ->group(kInput);
    declarePreprocessingOptions(app, options.preprocessing, kPreprocessing);
}

void declareRequirements(CLI::App& app, CheckOptions& options) {
    addChoice<Profile>(
        app, "--profile", options.profile,
        {{"bem", Profile::Bem}, {"print", Profile::Print}, {"view", Profile::View}},
        "bem: a boundary of a head model (default with --nested); print: a solid (default); "
        "view: to look at. See below")
        ->group(kRequired);
    const NumberRule length{.least = 0, .unit = "mm"};
    addNumber(app, "--min-gap", options.minGapMm, length,
              "With --nested: smallest gap between neighbours that passes, in any profile "
              "(default: 0.5, in bem only)")
        ->type_name("MM")
        ->group(kRequired);
    addNumber(app, "--min-angle", options.minAngleDeg, {.least = 0, .most = 60, .unit = "degrees"},
              "Smallest angle of a triangle that passes, 0 to 60, in any profile (default: 1, in "
              "bem only)")
        ->type_name("DEG")
        ->group(kRequired);
    addNumber(app, "--max-off", options.maxOffMm, length,
              "With --iso: largest distance from the isosurface that passes (default: the mean "
              "within half a voxel)")
        ->type_name("MM")
        ->group(kRequired);
}

void declareSelfTest(CLI::App& app, CheckOptions& options) {
    app.add_flag("--self-test", options.isSelfTest,
                 "Check this installation instead of files: phantoms whose size is known on paper, "
                 "from image to surface, and a defect for every check; a table to sign")
        ->group("Self-test (takes no files)");
}

/// The self-test makes its own input.
void checkSelfTestAlone(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const bool isOfRun = name == "--self-test" || name == "--json" || name == "--report" ||
                             name == "--pictures" || name == "--quiet" || name == "--threads" ||
                             name == "--strict" || name == "--no-warnings";
        if (option->count() > 0 && !isOfRun) {
            throw UsageError("--self-test: not together with " +
                             (name.starts_with("-") ? name : "files"));
        }
    }
}

void declareOutput(CLI::App& app, CheckOptions& options) {
    constexpr std::int64_t kMaxPairs = 1'000'000'000;
    addCount(app, "--max-pairs", options.maxPairs, 0, kMaxPairs,
             "List up to N pairs of triangles that cross in the report (default: 1000); all are "
             "counted")
        ->group(kOutput);
    declareReportOptions(app, options.report, kOutput);
}

/// Of the names of what is written: {name} stands for an input of a batch.
void checkPlaceholders(const CheckOptions& options) {
    const std::vector<std::string> forRun =
        options.batch.isAsked() ? std::vector<std::string>{"{name}"} : std::vector<std::string>{};
    requirePlaceholders("--report", options.report.page, forRun);
    requirePlaceholders("--pictures", options.report.pictures, forRun);
    requirePlaceholders("--summary", options.batch.summary, {});
    requirePlaceholders("--output-dir", options.batch.outputFolder, {});
    requirePlaceholders("--json", options.common.json, {});
}

/// What one option alone can't tell.
void checkCombinations(const CheckOptions& options) {
    const bool findsFiles = !options.batch.list.empty() || !options.batch.bids.empty();
    if (options.files.empty() && !findsFiles) {
        throw UsageError("FILE is missing: the surfaces to check");
    }
    if (options.isNested && options.files.size() < 2 && !findsFiles) {
        throw UsageError("--nested: needs at least two files, from inside to outside");
    }
    if (!findsFiles) {
        const bool areRuns = options.batch.isAsked() && !options.isNested;
        checkInputCoordinates(options.inputCoordinates, areRuns ? 1 : options.files.size());
    }
    if (options.minGapMm && !options.isNested) throw UsageError("--min-gap: needs --nested");
    if (options.isovalue && options.volume.empty()) throw UsageError("--iso: needs --volume");
    if (options.maxOffMm && !options.isovalue) throw UsageError("--max-off: needs --iso");
    if (!options.preprocessing.changesNothing() && !options.isovalue) {
        throw UsageError("--crop, --smooth, --resample: need --iso");
    }
}

constexpr const char* kFooter = R"(Required by the profiles:
  bem, print, view  coordinates finite; indices in range; orientation consistent
                    and outward; no duplicate triangle; where asked for: on the
                    isosurface, strictly nested and nowhere crossing
  bem, print        closed; edges and vertices manifold; no degenerate triangle;
                    no self-intersection; a size plausible in mm
  bem               one component; genus 0; no unused or duplicate vertex; no
                    angle below 1 degree; MNE's solid angle; a gap of 0.5 mm
What is not required is told all the same ("noted").

Two triangles intersect when they have a point in common that is not a corner
or edge which both share (touching is enough). Decided exactly.

Examples:
  adaptiso-check surface.stl
  adaptiso-check --nested inner_skull.surf outer_skull.surf outer_skin.surf
  adaptiso-check bone.ply --volume ct.nii.gz --iso 250 --json report.json
  adaptiso-check --nested *.surf --volume T1.mgz --report check.html
  adaptiso-check --quiet *.vtp || echo 'not all of them are sound'
  adaptiso-check *.vtp --jobs 4 --output-dir checked --skip-existing
      a line for each, each in a process of its own; a page checked/summary.html
  adaptiso-check --self-test --report self-test.html

Exit codes: 0 all that is required holds, 1 something does not, or there is a
warning with --strict, 2 wrong usage, 3 bad input (or no memory or disk left),
4 internal error. A file that can't be read does not keep the others from being
checked; the exit code is then 3.)";

}  // namespace

Program checkProgram() {
    return {"adaptiso-check", "Says whether triangle surfaces are sound, and where they are not.",
            kFooter};
}

void declareCheckOptions(CLI::App& app, CheckOptions& options) {
    declareInput(app, options);
    declareRequirements(app, options);
    declareSelfTest(app, options);
    declareOutput(app, options);
    declareBatchOptions(app, options.batch, "the surfaces in derivatives/adaptiso");
    declareCommonOptions(app, options.common, "reports are written all the same");
    app.callback([&app, &options] {
        if (options.isSelfTest) {
            checkSelfTestAlone(app);
            return;
        }
        checkCombinations(options);
        checkPlaceholders(options);
        if (options.batch.isAsked()) keepRunOptions(app, options.batch);
    });
}

}  // namespace adaptiso
