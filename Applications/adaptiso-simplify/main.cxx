#include <string>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Pipeline.h"
#include "Run.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::simplifier {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kAim = "Extent (at least one of the first three)";
constexpr const char* kKept = "Constraints";
constexpr const char* kOutput = "Output";

void checkAim(const SimplifyOptions& aim) {
    if (!aim.maxErrorMm && !aim.maxTriangles && !aim.reduction) {
        throw UsageError("--max-error, --triangles or --reduction is missing: how far to simplify");
    }
    requireOneCount(aim);
}

void declareInput(CLI::App& app, SimplifyCommand& command) {
    const OptionGroup input(app, kInput);
    OptionGroup(app).text(
        "MESH", "", command.inputs,
        "Triangle surfaces, in any format adaptiso-mesh writes; several make a batch");
    declareInputCoordinates(input, command.inputCoordinates, "the surfaces");
    input.text("--data", "FILE", command.data,
               "Values at the surface's points in a file of their own: FreeSurfer's "
               "lh.thickness, lh.curv, lh.sulc and the like, lh.aparc.annot, .mgh; GIFTI's "
               ".shape.gii, .func.gii, .label.gii. They are taken to the new points, numbers "
               "interpolated, labels from the nearest point, and written beside the surface "
               "under their own names. May be given several times");
}

void declareAim(CLI::App& app, SimplifyCommand& command) {
    OptionGroup(app, kAim).rows(aimOptions(AimedSurface::Mesh), command.aim);
    const OptionGroup kept(app, kKept);
    kept.rows(simplifyOptions(), command.aim);
    kept.flag("--require-sound", command.requiresSound,
              "Refuse (exit code 1, no surface written) a surface that is not closed, "
              "2-manifold and oriented, that crosses itself, or that has triangles without area "
              "or twice. Without it such places are reported, and kept as they are");
}

void declareOutput(CLI::App& app, SimplifyCommand& command) {
    const OptionGroup output(app, kOutput);
    output.text("-o,--output", "OUT", command.output,
                "The file to write, or a folder for files of the inputs' names (default, of one "
                "input: bone-simplified.stl of bone.stl in the current folder). {name} in its "
                "name stands for the input's. The format follows from the extension: " +
                    meshExtensions());
    declareCoordinates(output, command.frame,
                       "The points' frame in the file: scanner RAS mm, scanner LPS mm, "
                       "FreeSurfer's surface RAS mm, or voxel indices (default: as the "
                       "input has them)");
    output.rows(scaleOptions(), command.scale);
    declareReportOptions(app, command.report, kOutput);
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-simplify bone.stl --max-error 0.1 -o small.stl
  adaptiso-simplify lh.pial --triangles 20000 --data lh.thickness --data lh.aparc.annot -o small/
      small/lh.pial, small/lh.thickness and small/lh.aparc.annot
  adaptiso-simplify scan.ply --reduction 0.9 --keep-borders --report scan.html -o scan.vtp
  adaptiso-simplify *.stl --max-error 0.2 --require-sound --jobs 4 --skip-existing -o small/
      each a run of its own; a page small/summary.html

Exit codes: 0 done, 1 --require-sound and the surface is not, one or more of
many inputs failed, or a warning with --strict, 2 wrong usage, 3 bad input (or
no memory or disk left), 4 internal error. When it is not 0, no surface was
written (of many inputs: none of those that failed).)";

Program simplifyProgram() {
    return {"adaptiso-simplify",
            "Simplifies any triangle surface within a proved distance: what is closed stays "
            "closed, and nothing new crosses.",
            kFooter};
}

void declareSimplifyOptions(CLI::App& app, SimplifyCommand& command) {
    declareInput(app, command);
    declareAim(app, command);
    declareOutput(app, command);
    declareBatchOptions(app, command.batch);
    declareCommonOptions(app, command.common, "no surface is then written, reports are");
    afterParsing(app, [&app, &command] {
        std::vector<std::pair<const char*, std::filesystem::path>> named;
        for (const std::filesystem::path& data : command.data) named.emplace_back("--data", data);
        checkSurfaceFiles(app, command, "simplify", std::move(named));
        checkInputCoordinates(command.inputCoordinates, 1);
        checkAim(command.aim);
    });
}

}  // namespace
}  // namespace adaptiso::simplifier

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::simplifier::simplifyProgram(),
                            adaptiso::simplifier::declareSimplifyOptions,
                            adaptiso::simplifier::runSimplify);
}
