#include "TextReport.h"

#include <ostream>
#include <string>
#include <string_view>

#include "Common/Json.h"
#include "Common/Numbers.h"
#include "Common/RunApp.h"

namespace adaptiso::simplifier {
namespace {

std::string frameText(const std::optional<CoordinateFrame>& frame) {
    return frame ? std::string(toString(*frame)) : "frame not said";
}

void printInput(std::ostream& out, const SimplifyRun& run) {
    const SurfaceSummary& input = run.input;
    out << oneLine(input.file.string()) << ": " << formatCount(input.triangles) << " triangles, "
        << input.format->name << ", " << frameText(input.frame) << '\n';
    if (isSound(run.findings)) out << "  closed, 2-manifold, oriented, nothing crosses\n";
    for (const Finding& finding : run.findings) out << "  " << finding.text() << '\n';
}

void printOutput(std::ostream& out, const SimplifyRun& run) {
    const SurfaceSummary& output = run.output;
    const double percent =
        100.0 * static_cast<double>(output.triangles) / static_cast<double>(run.input.triangles);
    out << oneLine(output.file.string()) << (run.writesSurface() ? "" : " (not written)") << ": "
        << formatCount(output.triangles) << " triangles (" << formatFixed(percent, 1) << " %), "
        << output.format->name << ", " << frameText(output.frame) << '\n';
    out << "  no point farther than " << formatBound(run.errorBoundMm())
        << " mm from the input, nor it from this one (proved; farthest of "
        << formatCount(run.verification->samples)
        << " points measured: " << formatLength(run.verification->maxMm, 4) << " mm)\n";
    if (!run.countMet().value_or(true)) {
        out << "  " << formatCount(*run.statistics.wantedTriangles) << " triangles were asked for; "
            << (run.command.aim.maxErrorMm
                    ? "the bound of --max-error does not allow as few\n"
                    : "keeping all its pieces, holes and borders left little to gain\n");
    }
    for (const std::string& name : run.keptArrays) {
        out << "  with the values " << oneLine(name) << '\n';
    }
}

}  // namespace

void printReport(std::ostream& out, const SimplifyRun& run) {
    printInput(out, run);
    if (!run.failsSoundness()) {
        printOutput(out, run);
        for (const DataSummary& data : run.data) {
            out << oneLine(data.output.string()) << (run.writesSurface() ? "" : " (not written)")
                << ": " << (data.areLabels ? "labels" : "values") << " of "
                << oneLine(baseName(data.file)) << ", " << toString(data.format) << '\n';
        }
    }
    printTimes(out, run.timer);
}

}  // namespace adaptiso::simplifier
