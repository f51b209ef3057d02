#include "ReportPage.h"

#include <algorithm>

#include "Common/Json.h"
#include "Common/Numbers.h"
#include "Common/ReportOutput.h"
#include "TextReport.h"

namespace adaptiso {
namespace {

std::string nameOf(std::size_t n) {
    return std::string(toString(static_cast<HeadSurface>(n)));
}

std::string pairName(std::size_t inner) {
    return nameOf(inner) + " in " + nameOf(inner + 1);
}

void tellVerdict(const BemRun& run, Report& report) {
    const std::string layers = run.options.surfaceCount() == 1 ? "one layer" : "three layers";
    report.title = "Head model of " + layers;
    if (run.hasModel()) {
        report.verdict = ReportVerdict::Passed;
        report.headline =
            "All " + formatCount(std::ssize(run.checks)) +
            " checks hold: every surface is closed, in one piece, of genus 0 and does "
            "not cross itself" +
            (run.gaps.empty() ? "."
                              : "; they lie in each other with the gaps asked "
                                "for.");
        const std::int64_t notes = notedCount(run.plausibility);
        if (notes > 0) {
            report.headline += " " + formatCount(notes) +
                               (notes == 1 ? " thing is" : " things are") +
                               " unusual of a head model: worth a look.";
        }
    } else {
        report.verdict = ReportVerdict::Failed;
        report.headline = "No model could be guaranteed: " + failureText(run);
    }
}

void tellInputs(const BemRun& run, Report& report) {
    for (const BemInput& input : run.inputs) {
        report.inputs.push_back({input.role, baseName(input.path) + " (" + input.format + ")"});
    }
    if (!run.image) return;
    const std::vector<ReportFact> facts = imageFacts("", "", *run.image);
    report.inputs.insert(report.inputs.end(), facts.begin() + 1, facts.end());
}

void tellOptions(const BemRun& run, Report& report) {
    const BemOptions& options = run.options;
    const BoundaryOptions& head = options.boundaries;
    std::string triangles = run.source == "surfaces" ? "as the surfaces came, where they could stay"
                                                     : "2,562 vertices a surface (default)";
    if (options.vertices.size() == 1) {
        triangles = formatCount(options.vertices.front()) + " vertices a surface";
    } else if (!options.vertices.empty()) {
        triangles.clear();
        for (const std::int64_t count : options.vertices) {
            triangles += (triangles.empty() ? "" : ", ") + formatCount(count);
        }
        triangles += " vertices";
    }
    if (options.edgeLengthMm) {
        triangles = "edges of " + formatNumber(options.edgeLengthMm->minimumMm) + " to " +
                    formatNumber(options.edgeLengthMm->maximumMm) + " mm";
    }
    report.options = {{"Made from", run.source}, {"Triangles", triangles}};
    if (options.surfaceCount() > 1) {
        report.options.push_back(
            {"Skull, scalp at least",
             formatNumber(head.minSkullMm) + " mm, " + formatNumber(head.minScalpMm) + " mm"});
    }
    report.options.push_back({"Smoothing", formatNumber(head.smoothingMm) + " mm"});
    const ConductivityModel& sigma = options.conductivities;
    report.options.push_back({"Conductivity", "brain " + formatNumber(sigma.brain) + ", skull " +
                                                  formatNumber(sigma.skull) + ", scalp " +
                                                  formatNumber(sigma.scalp) + " S/m"});
    report.options.push_back(
        {"FreeSurfer's files in", run.tkRasVolume ? "tkRAS mm" : "scanner RAS mm"});
}

/// "inner_skull: one closed surface of genus 0" is told in two columns.
void tellChecks(const BemRun& run, Report& report) {
    for (const BemCheck& check : run.checks) {
        const std::size_t colon = check.name.find(": ");
        report.checks.push_back(
            {check.name.substr(0, colon),
             colon == std::string::npos ? check.name : check.name.substr(colon + 2),
             check.isPassed ? ReportOutcome::Passed : ReportOutcome::Failed, check.detail});
    }
}

void tellSpots(const BemRun& run, Report& report) {
    for (const Finding& finding : run.findings) {
        report.spots.push_back({finding.what, finding.pointMm});
    }
    for (std::size_t n = 0; n < run.gaps.size(); ++n) {
        const NestedGap& gap = run.gaps[n];
        report.spots.push_back(
            {"smallest gap, " + formatFixed(gap.mm, 2) + " mm, of " + pairName(n),
             0.5 * (gap.innerPointMm + gap.outerPointMm), false});
    }
}

ReportTable surfaceTable(const BemRun& run) {
    ReportTable table{
        "Surfaces",
        {"Surface", "Vertices", "Triangles", "Area, cm²", "Volume, cm³", "Edges, mm",
         "Smallest angle", "From the dense surface, mm (mean, most)", "Moved to nest, mm"},
        {}};
    for (std::size_t n = 0; n < run.surfaces.size(); ++n) {
        const BemSurface& surface = run.surfaces[n];
        const auto& remesh = surface.remesh;
        table.rows.push_back(
            {nameOf(n), formatCount(surface.topology.vertices),
             formatCount(surface.topology.triangles), formatRounded(surface.areaMm2 / 100),
             formatRounded(surface.volumeMm3 / 1000),
             formatFixed(surface.shape.edgeMm.minimum, 1) + " to " +
                 formatFixed(surface.shape.edgeMm.maximum, 1),
             formatFixed(surface.shape.minAngleDeg.minimum, 1) + "°",
             remesh ? formatFixed(remesh->meanVertexDistanceMm, 2) + ", " +
                          formatFixed(remesh->maximumVertexDistanceMm, 2)
                    : "as it came",
             surface.move.movedVertices > 0 ? "up to " + formatFixed(surface.move.maximumMm, 2)
                                            : "–"});
    }
    return table;
}

ReportTable fileTable(const BemRun& run) {
    ReportTable table{"Files written", {"File", "Bytes"}, {}};
    for (const auto& [name, bytes] : run.files) {
        table.rows.push_back({name, formatCount(static_cast<long long>(bytes))});
    }
    return table;
}

}  // namespace

Report makeReport(const BemRun& run, const std::vector<TriangleMesh>& surfaces) {
    Report report;
    tellVerdict(run, report);
    tellInputs(run, report);
    tellOptions(run, report);
    tellChecks(run, report);
    tellSpots(run, report);
    addNotes(run.plausibility, report);
    if (!run.checks.empty()) report.tables.push_back(surfaceTable(run));
    if (!run.files.empty()) report.tables.push_back(fileTable(run));
    report.notes = run.warnings;
    tellStrict(report, run.options.common, run.warnings, "so no model was written");
    report.notes.insert(report.notes.end(), run.notes.begin(), run.notes.end());
    if (run.options.isDryRun) report.notes.push_back("Nothing else was written (--dry-run).");
    if (!run.hasModel() && !surfaces.empty()) {
        report.notes.push_back(
            "The surfaces shown are those that the model was tried from; none was written.");
    }
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        report.surfaces.push_back({nameOf(n), surfaces[n]});
        report.surfaces.back().isWithinSkull =
            static_cast<HeadSurface>(n) == HeadSurface::InnerSkull && run.source != "surfaces";
    }
    if (run.shownImage) {
        report.volume = ReportVolume{run.inputs.front().role, run.shownImage->volume.view()};
    }
    report.stageSeconds = run.timer.stages();
    return report;
}

}  // namespace adaptiso
