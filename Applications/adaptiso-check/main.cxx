#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Pipeline.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"

namespace adaptiso::checker {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kPreprocessing = "Preprocessing of the volume for --iso (in this order)";
constexpr const char* kRequired = "Requirements (exit code 1 when one does not hold)";
constexpr const char* kOutput = "Output";

void declareInput(CLI::App& app, CheckOptions& options) {
    const OptionGroup input(app, kInput);
    OptionGroup(app).text("FILE", "", options.files,
                          "Triangle surfaces, in any format adaptiso-mesh writes, however broken");
    input.flag("--nested", options.isNested,
               "The files are the surfaces of one head, from inside to outside (INNER MIDDLE "
               "OUTER): check how they lie in each other too");
    declareInputCoordinates(input, options.inputCoordinates,
                            "all surfaces; given once for each file, that of each");
    declareVolume(app, options.volume, options.read,
                  "The image that the surfaces were made from; gives a place to tkRAS and voxel "
                  "coordinates",
                  kInput);
    input.number("--iso", "V", options.isovalue, {},
                 "Measure how far the surfaces lie from the volume's isosurface at this value");
    declarePreprocessingOptions(app, options.preprocessing, kPreprocessing);
}

void declareRequirements(CLI::App& app, CheckOptions& options) {
    const OptionGroup required(app, kRequired);
    required.rows(ruleOptions(), options);
}

void declareSelfTest(CLI::App& app, CheckOptions& options) {
    const OptionGroup group(app, "Self-test (takes no files)");
    group.flag("--self-test", options.isSelfTest,
               "Check this installation instead of files: phantoms whose size is known on paper, "
               "from image to surface, and a defect for every check; a table to sign");
}

/// The self-test makes its own input.
void checkSelfTestAlone(const CLI::App& app) {
    const std::set<std::string> own{"--self-test", "--json",     "--log",
                                    "--report",    "--pictures", "--quiet",
                                    "--threads",   "--strict",   "--no-warnings"};
    for (const std::string& name : givenOptions(app)) {
        if (own.contains(name)) continue;
        throw UsageError("--self-test: not together with " +
                         (name.starts_with("-") ? name : "files"));
    }
}

void declareOutput(CLI::App& app, CheckOptions& options) {
    const OptionGroup output(app, kOutput);
    output.rows(pairOptions(), options);
    declareReportOptions(app, options.report, kOutput);
}

/// Checks options against each other.
void checkCombinations(const CheckOptions& options) {
    const bool findsFiles = !options.batch.list.empty();
    if (options.files.empty() && !findsFiles) {
        throw UsageError("FILE is missing: the surfaces to check");
    }
    if (options.isNested && options.files.size() < 2 && !findsFiles) {
        throw UsageError("--nested: needs at least two files, from inside to outside");
    }
    if (!findsFiles) {
        const bool areRuns = options.batch.isRequested() && !options.isNested;
        checkInputCoordinates(options.inputCoordinates, areRuns ? 1 : options.files.size());
    }
    if (options.minGapMm && !options.isNested) throw UsageError("--min-gap: needs --nested");
    if (options.isovalue && options.volume.empty()) throw UsageError("--iso: needs --volume");
    if (options.maxOffMm && !options.isovalue) throw UsageError("--max-off: needs --iso");
    if (!options.preprocessing.changesNothing() && !options.isovalue) {
        throw UsageError("--crop, --smooth, --resample: need --iso");
    }
}

/// "bem, print   closed; edges manifold; ...", for --help.
std::string requiredText(std::string_view profiles, bool print, bool view) {
    constexpr std::size_t kIndent = 20, kColumns = 80;
    std::string text, line = "  " + std::string(profiles);
    line.resize(kIndent, ' ');
    bool isFirst = true;
    for (const CheckRule& rule : checkRules()) {
        if (!rule.bem || rule.print != print || rule.view != view) continue;
        if (!isFirst) line += "; ";
        if (line.size() + rule.name.size() >= kColumns) {
            text += line.substr(0, line.size() - 1) + "\n";
            line.assign(kIndent, ' ');
        }
        line += rule.name;
        isFirst = false;
    }
    return text + line + "\n";
}

constexpr const char* kFooter = R"(Other findings are reported as "noted".

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
checked; the exit code is then 3; in a batch (--jobs, --output-dir, --csv or
--list) it is 1, as for any failed run.)";

Program checkProgram() {
    return {kProgram, "Checks whether triangle surfaces are sound, and shows where they are not.",
            "Required by the profiles:\n" + requiredText("bem, print, view", true, true) +
                requiredText("bem, print", true, false) + requiredText("bem", false, false) +
                kFooter};
}

void declareCheckOptions(CLI::App& app, CheckOptions& options) {
    declareInput(app, options);
    declareRequirements(app, options);
    declareSelfTest(app, options);
    declareOutput(app, options);
    declareBatchOptions(app, options.batch);
    declareCommonOptions(app, options.common, "reports are written all the same");
    afterParsing(app, [&app, &options] {
        if (options.isSelfTest) {
            checkSelfTestAlone(app);
            return;
        }
        if (!options.batch.isRequested()) {
            std::vector<std::filesystem::path> files;
            for (const auto& file : options.files) {
                for (auto& path : surfacePaths(file)) files.push_back(std::move(path));
            }
            options.files = std::move(files);
        }
        checkCombinations(options);
        options.measuresWalls = options.minWallMm || options.profile == Profile::Print;
        const std::vector<std::pair<const char*, std::filesystem::path>> named{
            {"--report", options.report.page}, {"--pictures", options.report.pictures}};
        checkPlaceholders(named, options.batch, options.common);
        for (const auto& [option, output] : named) {
            if (!options.batch.isRequested()) requirePlaceholders(option, output, {});
        }
        if (options.batch.isRequested()) keepRunOptions(app, options.batch);
    });
}

}  // namespace
}  // namespace adaptiso::checker

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::checker::checkProgram(),
                            adaptiso::checker::declareCheckOptions, adaptiso::checker::runCheck);
}
