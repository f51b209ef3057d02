#include "CommandLine.h"

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/ReportOutput.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso {
namespace {

constexpr const char* kPlanned = "What to make (plan, run)";
constexpr const char* kResult = "Result (join, run)";
constexpr const char* kRunning = "Running";

void declareArguments(CLI::App& app, GiantOptions& options) {
    app.add_option_function<std::string>(
           "STEP",
           [&options](const std::string& text) {
               options.step = static_cast<GiantStep>(
                   parseChoice("STEP", text, {"plan", "tile", "seam", "join", "run"}));
           },
           "plan: which tiles there are; tile: their surfaces; seam: what lies across their walls "
           "(method adaptive); join: counts, and the result; run: all of them, here")
        ->type_name("")
        ->required();
    app.add_option("WORK", options.work,
                   "The folder of the plan and of what the steps leave; several steps may work on "
                   "it at once")
        ->type_name("")
        ->required();
    app.add_option("ID", options.ids,
                   "The tiles or seam boxes to make, as plan.json names them (default: all); what "
                   "is there already is not made again")
        ->type_name("");
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
        app.add_option_function<std::vector<std::string>>(
               name, [text = std::string(name) +
                             reason](const std::vector<std::string>&) { throw UsageError(text); })
            ->expected(0, 1)
            ->group("");
    }
}

void declarePlanned(CLI::App& app, GiantOptions& options) {
    app.add_option(
           "--input", options.input,
           "The image: a Zarr, OME-Zarr or N5, of which only what a tile needs is read, or any "
           "other that adaptiso-mesh reads")
        ->type_name("IMG")
        ->group(kPlanned);
    addNumber(app, "--iso", options.isovalue, {},
              "The isovalue: samples of it and above are inside")
        ->type_name("VALUE")
        ->group(kPlanned);
    addValue(
        app, "--method", "adaptive|mc",
        [&options](const std::string& text) { options.method = methodOf(text); },
        "adaptive: few triangles within a distance of the surface of marching cubes; mc: that "
        "surface (default: adaptive). The others need the whole volume")
        ->group(kPlanned);
    addNumber(app, "--max-error", options.maxErrorMm, {.least = 0, .isAbove = true, .unit = "mm"},
              "Of method adaptive: no point is farther than MM from the surface of marching cubes, "
              "nor the other way round (default: 0.15 of the least distance of sample planes)")
        ->type_name("MM")
        ->group(kPlanned);
    addCount(app, "--tile", options.side, TileCut::kStep, TileCut::kLargestSide,
             "Cells a side of a tile, a multiple of 32 (default: 384)")
        ->group(kPlanned);
    declareReadOptions(app, options.read, kPlanned);
}

void declareResult(CLI::App& app, GiantOptions& options) {
    app.add_option("-o,--output", options.output,
                   "The surface: .ply, one file, or .pvtp, a list of .vtp pieces in a folder of "
                   "that name, for ParaView. Without it the surface is measured only")
        ->type_name("OUT")
        ->group(kResult);
    app.add_option("--preview", options.preview,
                   "A coarse copy of at most 200,000 triangles, to be looked at; its triangles may "
                   "cross")
        ->type_name("OUT")
        ->group(kResult);
    declareReportOptions(app, options.report, kResult);
    addChoice<CoordinateFrame>(app, "--coordinates", options.frame,
                               {{"ras", CoordinateFrame::Ras},
                                {"lps", CoordinateFrame::Lps},
                                {"voxel", CoordinateFrame::Voxel}},
                               "The points' frame in the file: RAS mm, LPS mm, or voxel indices "
                               "(default: ras)")
        ->group(kResult);
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
    require(!options.maxErrorMm || options.method == Method::Adaptive,
            "--max-error: is for the method adaptive");
    require(
        options.ids.empty() || options.step == GiantStep::Tile || options.step == GiantStep::Seam,
        "ID: only the steps tile and seam take any");
    for (const char* name : {"--input", "--iso", "--method", "--max-error", "--tile", "--level",
                             "--channel", "--time", "--volume-index"}) {
        require(plans || app.get_option(name)->count() == 0,
                std::string(name) + ": the plan says it; give it to plan or run");
    }
    for (const char* name :
         {"--output", "--preview", "--report", "--pictures", "--deface-report", "--coordinates"}) {
        require(joins || app.get_option(name)->count() == 0,
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

}  // namespace

Program giantProgram() {
    return {"adaptiso-giant",
            "Makes the surface of a volume that no memory holds, tile by tile: closed, within a "
            "proved bound.",
            kFooter};
}

void declareGiantOptions(CLI::App& app, GiantOptions& options) {
    declareArguments(app, options);
    declarePlanned(app, options);
    declareResult(app, options);
    refuseWhatNeedsTheWhole(app);
    addCount(app, "--workers", options.workers, 1, 1024,
             "Step run: work on N tiles at a time, each by a process of its own (default: 1)")
        ->group(kRunning);
    declareCommonOptions(app, options.common, "no plan is then written");
    app.callback([&app, &options] { checkCombinations(app, options); });
}

}  // namespace adaptiso
