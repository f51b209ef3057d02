
#include "Common/CommonFrame.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Pipeline.h"
#include "Run.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::mender {
namespace {

constexpr const char* kOutput = "Output";

void checkCombinations(const MendCommand& command) {
    checkInputCoordinates(command.inputCoordinates, command.around.empty() ? 1 : 2);
    if (command.around.empty() == command.gapMm.has_value()) {
        throw UsageError("--around FIXED, --gap MM: each needs the other");
    }
    if (command.isDryRun && command.scale.isWanted()) {
        throw UsageError("--scale, --fit: are for the file to write, not with --dry-run");
    }
    if (command.aim.removesHandles && command.aim.leavesHolesOpen) {
        throw UsageError("--ball takes closed surfaces: not with --open");
    }
    if (command.gapMm && command.aim.leavesHolesOpen) {
        throw UsageError("--around takes closed surfaces: not with --open");
    }
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-mend scan.ply
      writes scan-mended.ply into the current folder
  adaptiso-mend scan.ply --dry-run
      what is wrong with it, and what would be changed; nothing is written
  adaptiso-mend lh.pial --max-error 0.1 -o mended/lh.pial
  adaptiso-mend mask.stl --max-hole 20 -o mask.vtp
      holes up to 20 mm wide are closed; --open leaves wider ones open
  adaptiso-mend skull.ply --ball -o ball.ply
      handles are cut or filled, whichever takes the smaller disc
  adaptiso-mend skull.stl --around brain.stl --gap 2 -o around.stl
      then moved out where it lies less than 2 mm around the brain
  adaptiso-mend *.stl --jobs 4 --skip-existing -o mended/
      each a run of its own; a page mended/summary.html

Exit codes: 0 mended, or sound already, 1 it can't be mended as asked, one or
more of many inputs failed, or a warning with --strict, 2 wrong usage, 3 bad
input (or no memory or disk left), 4 internal error. When it is not 0, no
surface was written (of many inputs: none of those that failed).)";

Program mendProgram() {
    return {"adaptiso-mend",
            "Makes a solid of any mesh within a proved distance: closed, 2-manifold, oriented, "
            "crossing itself nowhere.",
            kFooter};
}

void declareMendOptions(CLI::App& app, MendCommand& command) {
    OptionGroup(app).text("MESH", "", command.inputs,
                          "Meshes of triangles or polygons, in any format adaptiso-mesh writes, "
                          "with any faults; several make a batch");
    declareInputCoordinates(OptionGroup(app, "Input"), command.inputCoordinates,
                            "the mesh, given twice also of the surface of --around");
    const OptionGroup extent(app, "Extent");
    extent.rows(mendOptions(), command.aim);
    extent.rows(pieceOptions(), command.aim.pieces);
    extent.text("--around", "FIXED", command.around,
                "Move the result outward where it must, to lie around this surface. Each is in "
                "one piece");
    extent.number("--gap", "MM", command.gapMm, {.least = 0, .isAbove = true, .unit = "mm"},
                  "Least distance to that surface (a number above 0, in mm)");
    const OptionGroup output(app, kOutput);
    output.text("-o,--output", "OUT", command.output,
                "The file to write, or a folder for files of the inputs' names (default, of one "
                "input: scan-mended.ply of scan.ply in the current folder). {name} in its "
                "name stands for the input's. The format follows from the extension: " +
                    meshExtensions());
    declareCoordinates(output, command.frame,
                       "The points' frame in the file: scanner RAS mm, scanner LPS mm, or "
                       "FreeSurfer's surface RAS mm (default: as the input has them)",
                       {"ras", "lps", "tkras"});
    output.rows(scaleOptions(), command.scale);
    output.flag("--dry-run", command.isDryRun, "Report only; write no surface");
    declareReportOptions(app, command.report, kOutput);
    declareBatchOptions(app, command.batch);
    declareCommonOptions(app, command.common, "no surface is then written, reports are");
    afterParsing(app, [&app, &command] {
        checkSurfaceFiles(app, command, "mend", {{"--around", command.around}}, !command.isDryRun);
        checkCombinations(command);
    });
}

}  // namespace
}  // namespace adaptiso::mender

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::mender::mendProgram(),
                            adaptiso::mender::declareMendOptions, adaptiso::mender::runMend);
}
