#include "ReportPage.h"

#include <algorithm>

#include "Common/Json.h"
#include "Common/Numbers.h"
#include "Common/ReportOutput.h"
#include "Common/SpotClusters.h"
#include "Frames.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso::simplifier {
namespace {

void tellVerdict(const SimplifyRun& run, Report& report) {
    report.title = baseName(run.input.file) + " simplified";
    if (run.failsSoundness()) {
        report.verdict = ReportVerdict::Failed;
        report.headline = "Not simplified: the surface is not sound, and it is asked to be.";
        return;
    }
    report.headline = formatCount(run.output.triangles) + " triangles of " +
                      formatCount(run.input.triangles) + "; no point farther than " +
                      formatBound(run.errorBoundMm()) +
                      " mm from the input, nor the other way round.";
}

void tellInputs(const SimplifyRun& run, Report& report) {
    const SurfaceSummary& input = run.input;
    report.inputs.push_back(
        {"Surface", baseName(input.file) + " (" + std::string(input.format->name) + ", " +
                        (input.frame ? std::string(toString(*input.frame)) : "frame not said") +
                        ")"});
    for (const DataSummary& data : run.data) {
        report.inputs.push_back(
            {"Values", baseName(data.file) + " (" + std::string(toString(data.format)) + ")"});
    }
}

void tellOptions(const SimplifyCommand& command, Report& report) {
    const SimplifyOptions& aim = command.aim;
    if (aim.maxErrorMm) {
        report.options.push_back({"Largest error", formatNumber(*aim.maxErrorMm) + " mm"});
    }
    if (aim.maxTriangles) {
        report.options.push_back({"Triangles at most", formatCount(*aim.maxTriangles)});
    }
    if (aim.reduction) {
        report.options.push_back({"Share of triangles to drop", formatNumber(*aim.reduction)});
    }
    if (aim.minAngleDeg > 0) {
        report.options.push_back({"Smallest angle", formatNumber(aim.minAngleDeg) + "°"});
    }
    report.options.push_back(
        {"Open borders", aim.keepBorders ? "kept as they are" : "simplified within the bound"});
}

void tellChecks(const SimplifyRun& run, Report& report) {
    const auto add = [&](const std::string& subject, const std::string& name, bool holds,
                         const std::string& finding) {
        const ReportOutcome bad =
            run.failsSoundness() ? ReportOutcome::Failed : ReportOutcome::Noted;
        report.checks.push_back({subject, name, holds ? ReportOutcome::Passed : bad, finding});
    };
    const std::string input = baseName(run.input.file);
    if (isSound(run.findings)) {
        add(input, "closed, 2-manifold, oriented, not crossing itself", true, "");
    }
    for (const Finding& finding : run.findings) {
        if (finding.isFault) add(input, "sound", false, finding.text());
    }
    if (run.failsSoundness()) return;
    const std::string output = baseName(run.output.file);
    add(output, "as sound as the input, as written", true, "");
    add(output, "within the proved distance", true,
        formatLength(run.verification->maxMm, 4) + " mm at most at " +
            formatCount(run.verification->samples) + " points, " + formatBound(run.errorBoundMm()) +
            " mm proved");
}

ReportTable surfaceTable(const SimplifyRun& run) {
    ReportTable table{"Surfaces",
                      {"Surface", "File", "Triangles", "Vertices", "Pieces", "Genus", "Area, mm²"},
                      {}};
    const auto add = [&](const SurfaceSummary& surface) {
        const auto genus = surface.topology.genus();
        table.rows.push_back({&surface == &run.input ? "read" : "written", baseName(surface.file),
                              formatCount(surface.triangles), formatCount(surface.vertices),
                              formatCount(std::ssize(surface.topology.components)),
                              genus ? formatCount(*genus) : "–", formatMeasure(surface.areaMm2)});
    };
    add(run.input);
    if (!run.failsSoundness()) add(run.output);
    return table;
}

void tellSpots(const SimplifyRun& run, const TriangleMesh& input, const PageFrame& frame,
               Report& report) {
    const std::string in = " in " + baseName(run.input.file);
    for (const Finding& finding : run.findings) {
        if (!finding.placeMm || !finding.isFault) continue;
        if (finding.key == "crossingTriangles" && !run.statistics.crossingTriangles.empty()) {
            SpotClusters clusters(input);
            for (const std::int64_t t : run.statistics.crossingTriangles) {
                clusters.add(middleOf(input, t));
            }
            clusters.tell("crossing triangles" + in, run.failsSoundness(), report.spots);
            continue;
        }
        report.spots.push_back(
            {finding.what + in, frame.toLps(*finding.placeMm), run.failsSoundness()});
    }
}

}  // namespace

Report makeReport(const SimplifyRun& run, const MeshFile& input, TriangleMesh shown) {
    Report report;
    tellVerdict(run, report);
    tellInputs(run, report);
    tellOptions(run.command, report);
    tellChecks(run, report);
    const PageFrame frame = pageFrame(input);
    report.frame = frame.name;
    TriangleMesh before = transformed(input.mesh, frame.toLps);
    tellSpots(run, before, frame, report);
    if (run.failsSoundness()) {
        report.surfaces.push_back({baseName(run.input.file), std::move(before)});
    } else {
        TriangleMesh after = transformed(shown, frame.toLps);
        std::vector<double> distances = vertexDistancesMm(after, before);
        report.surfaces.push_back(
            {baseName(run.output.file), std::move(after), std::move(distances)});
    }
    report.tables.push_back(surfaceTable(run));
    report.warnings = linesOf(run.warnings);
    tellStrict(report, run.command.common, run.warnings, kNotWritten);
    return report;
}

}  // namespace adaptiso::simplifier
