#include <string>
#include <utility>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Pipeline.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso::giant {
namespace {

constexpr const char* kPlanned = "Surface (plan, run)";
constexpr const char* kResult = "Result (join, run)";
constexpr const char* kRunning = "Running";

void declareArguments(CLI::App& app, GiantOptions& options) {
    const OptionGroup arguments(app);
    required(arguments.value(
        "STEP", "",
        [&options](const std::string& text) {
            options.step = static_cast<GiantStep>(
                parseChoice("STEP", text, {"plan", "tile", "seam", "join", "run"}));
        },
        "plan: which tiles there are; tile: their surfaces; seam: what lies across their walls "
        "(method adaptive); join: counts, and the result; run: all of them, here"));
    required(
        arguments.text("WORK", "", options.work,
                       "The folder of the plan and of the steps' files; several steps may work on "
                       "it at once"));
    arguments.text("ID", "", options.ids,
                   "The tiles or seam boxes to make, as plan.json names them (default: all); what "
                   "is there already is not made again");
}

Method methodOf(const std::string& text) {
    for (const char* const whole : {"boxes", "asc", "dmc"}) {
        if (text != whole) continue;
        throw UsageError("--method " + text +
                         ": its facets may be as long as the volume, so tiles can't have it; take "
                         "adaptive or mc, or adaptiso-mesh");
    }
    return parseChoice("--method", text, {"adaptive", "mc"}) == 0 ? Method::Adaptive
                                                                  : Method::MarchingCubes;
}

/// Options of adaptiso-mesh that --help does not list here: each is refused with its reason.
void refuseWhatNeedsTheWhole(CLI::App& app) {
    const OptionGroup hidden(app, "");
    constexpr const char* kCounts =
        ": where triangles are saved is decided over the whole volume; take --max-error, or "
        "adaptiso-mesh, or adaptiso-simplify on the result";
    constexpr const char* kPieces =
        ": what is one piece is known when tiles are joined; choose by adaptiso-mesh, or leave "
        "pieces out of the result";
    constexpr const char* kBorder =
        ": join proves that the surface is closed, and so closes it at the volume's border";
    for (const auto& [name, reason] : {std::pair{"--triangles", kCounts},
                                       {"--reduction", kCounts},
                                       {"--largest", kPieces},
                                       {"--min-volume", kPieces},
                                       {"--border", kBorder}}) {
        hidden.refused(name, std::string(name) + reason);
    }
}

void declarePlanned(CLI::App& app, GiantOptions& options) {
    const OptionGroup planned(app, kPlanned);
    planned.text(
        "--input", "IMG", options.input,
        "The image: a Zarr, OME-Zarr or N5, of which only what a tile needs is read, or any "
        "other that adaptiso-mesh reads");
    planned.number("--iso", "VALUE", options.isovalue, {},
                   "The isovalue: samples of it and above are inside");
    planned.value(
        "--method", "adaptive|mc",
        [&options](const std::string& text) { options.method = methodOf(text); },
        "adaptive: few triangles within a distance of the surface of marching cubes; mc: that "
        "surface (default: adaptive). The others need the whole volume");
    planned.rows(aimOptions(AimedSurface::OfScan), options.aims, {"max-error"});
    planned.count("--tile", options.side, TileCut::kStep, TileCut::kLargestSide,
                  "Cells a side of a tile, a multiple of 32 (default: 384)");
    declareReadOptions(app, options.read, kPlanned);
}

void declareResult(CLI::App& app, GiantOptions& options) {
    const OptionGroup result(app, kResult);
    result.text("-o,--output", "OUT", options.output,
                "The surface: .ply, one file, or .pvtp, a list of .vtp pieces in a folder of "
                "that name, for ParaView. Without it the surface is measured only");
    result.text("--preview", "OUT", options.preview,
                "A coarse copy of at most 200,000 triangles, to be looked at; its triangles may "
                "cross");
    declareReportOptions(app, options.report, kResult);
    declareCoordinates(result, options.frame,
                       "The points' frame in the file: RAS mm, LPS mm, or voxel indices "
                       "(default: ras)",
                       {"ras", "lps", "voxel"});
}

void checkCombinations(const CLI::App& app, const GiantOptions& options) {
    const auto require = [](bool isGood, const std::string& message) {
        if (!isGood) throw UsageError(message);
    };
    const bool plans = options.step == GiantStep::Plan || options.step == GiantStep::Run,
               joins = options.step == GiantStep::Join || options.step == GiantStep::Run;
    require(!plans || !options.input.empty(), "--input is missing: the image");
    require(!plans || options.isovalue.has_value(), "--iso is missing: the isovalue");
    require(options.side % TileCut::kStep == 0,
            "--tile " + std::to_string(options.side) + ": must be a multiple of 32");
    require(!options.aims.maxErrorMm || options.method == Method::Adaptive,
            "--max-error: is for the method adaptive");
    require(
        options.ids.empty() || options.step == GiantStep::Tile || options.step == GiantStep::Seam,
        "ID: only the steps tile and seam take any");
    std::vector<std::string> planned{"--input", "--iso", "--method", "--max-error", "--tile"};
    for (const auto& row : readOptions()) planned.push_back("--" + std::string(row.facts.name));
    for (const std::string& name : planned) {
        require(plans || !isGiven(app, name), name + ": the plan says it; give it to plan or run");
    }
    for (const char* name :
         {"--output", "--preview", "--report", "--pictures", "--deface-report", "--coordinates"}) {
        require(joins || !isGiven(app, name),
                std::string(name) + ": is for the steps join and run");
    }
    const std::string extension = options.output.extension().string();
    require(options.output.empty() || extension == ".ply" || extension == ".pvtp",
            "--output " + options.output.string() +
                ": must end in .ply or .pvtp; the other formats need the whole surface in memory");
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-giant run work --input brain.zarr --iso 120 --workers 2 -o brain.pvtp
      all steps here; killed and started again, it goes on where it was
  adaptiso-giant plan work --input brain.zarr --iso 120 --method adaptive
  adaptiso-giant tile work 0_0_0 1_0_0
  adaptiso-giant seam work 0_0_0
  adaptiso-giant join work -o brain.ply --json brain.json
      the same in steps, for a cluster: Examples/giant

The bytes do not depend on who made which piece when. What a step finds of the
same plan and the same input (size and time of its files) it does not make again.

Exit codes: 0 done, 1 a warning with --strict, 2 wrong usage, 3 bad input (or no
memory or disk left, or a piece that is missing), 4 internal error.)";

Program giantProgram() {
    return {"adaptiso-giant",
            "Makes the surface of a volume that no memory holds, tile by tile: closed, within a "
            "proved bound.",
            kFooter};
}

void declareGiantOptions(CLI::App& app, GiantOptions& options) {
    const OptionGroup running(app, kRunning);
    declareArguments(app, options);
    declarePlanned(app, options);
    declareResult(app, options);
    refuseWhatNeedsTheWhole(app);
    running.count("--workers", options.workers, 1, 1024,
                  "Step run: work on N tiles at a time, each by a process of its own (default: 1)");
    declareCommonOptions(app, options.common, "no plan is then written");
    afterParsing(app, [&app, &options] { checkCombinations(app, options); });
}

}  // namespace
}  // namespace adaptiso::giant

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::giant::giantProgram(),
                            adaptiso::giant::declareGiantOptions, adaptiso::giant::runGiant);
}
