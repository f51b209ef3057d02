#include "ReportPage.h"

#include <algorithm>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Numbers.h"
#include "Common/ReportOutput.h"

namespace adaptiso::compare {
namespace {

void tellVerdict(const CompareRun& run, const std::string& a, const std::string& b,
                 Report& report) {
    const DistanceStatistics& distances = run.distances.combined;
    report.title = "Distance between " + a + " and " + b;
    report.headline = formatLength(distances.meanMm, 3) + " mm on the mean, " +
                      formatFixed(distances.p95Mm, 3) + " mm at 95 %, " +
                      formatLength(distances.maxMm, 3) + " mm at most.";
    if (run.checks.empty()) return;
    const bool havePassed = std::all_of(run.checks.begin(), run.checks.end(),
                                        [](const Check& check) { return check.hasPassed(); });
    report.verdict = havePassed ? ReportVerdict::Passed : ReportVerdict::Failed;
    for (const Check& check : run.checks) {
        report.checks.push_back({a + " and " + b, check.name,
                                 check.hasPassed() ? ReportOutcome::Passed : ReportOutcome::Failed,
                                 formatLength(check.valueMm, 4) + " mm, at most " +
                                     formatNumber(check.limitMm) + " mm"});
    }
}

void tellInputs(const CompareRun& run, Report& report) {
    const auto tell = [&](const char* name, const SurfaceSummary& surface) {
        report.inputs.push_back(
            {name, baseName(surface.file) + " (" + std::string(surface.format->name) + ", " +
                       (surface.frame ? std::string(toString(*surface.frame)) : "frame not said") +
                       ")"});
    };
    tell("A", run.a);
    tell("B, the reference", run.b);
    if (!run.volume) return;
    const std::vector<ReportFact> facts =
        imageFacts(baseName(run.options.volume), run.volume->format, run.volume->geometry);
    report.inputs.insert(report.inputs.end(), facts.begin(), facts.end());
}

void tellOptions(const CompareRun& run, Report& report) {
    report.options = {{"Points", formatCount(run.options.samples) + " in each direction"},
                      {"Directions", run.options.isSymmetric ? "A to B and B to A" : "A to B"}};
    if (run.options.maxMeanMm) {
        report.options.push_back({"Mean at most", formatNumber(*run.options.maxMeanMm) + " mm"});
    }
    if (run.options.maxHausdorffMm) {
        report.options.push_back(
            {"All at most", formatNumber(*run.options.maxHausdorffMm) + " mm"});
    }
}

ReportTable distanceTable(const CompareRun& run) {
    ReportTable table{"Distances, mm",
                      {"Direction", "Mean", "Root mean square", "95 %", "99 %", "Largest",
                       "Angle between the surfaces, mean"},
                      {}};
    const auto add = [&](const std::string& name, const DistanceStatistics& statistics) {
        table.rows.push_back({name, formatLength(statistics.meanMm, 4),
                              formatLength(statistics.rmsMm, 4), formatLength(statistics.p95Mm, 4),
                              formatLength(statistics.p99Mm, 4), formatLength(statistics.maxMm, 4),
                              formatFixed(statistics.meanNormalDeviationDeg, 2) + "°"});
    };
    add("A to B", run.distances.aToB);
    if (run.options.isSymmetric) {
        add("B to A", run.distances.bToA);
        add("both", run.distances.combined);
    }
    return table;
}

ReportTable surfaceTable(const CompareRun& run) {
    ReportTable table{
        "Surfaces", {"Surface", "Triangles", "Vertices", "Area, mm²", "Volume, mm³"}, {}};
    for (const SurfaceSummary* surface : {&run.a, &run.b}) {
        table.rows.push_back({baseName(surface->file), formatCount(surface->triangles),
                              formatCount(surface->vertices), formatMeasure(surface->areaMm2),
                              surface->volumeMm3 ? formatMeasure(*surface->volumeMm3) : "–"});
    }
    return table;
}

ReportSpot farthest(const DistanceStatistics& statistics, const std::string& from,
                    const std::string& to, bool isFailure) {
    return {"farthest point of " + from + " from " + to + ", " + formatLength(statistics.maxMm, 3) +
                " mm",
            statistics.maxPointMm, isFailure};
}

}  // namespace

Report makeReport(const CompareRun& run, ShownSurfaces& shown) {
    std::string a = baseName(run.a.file), b = baseName(run.b.file);
    if (a == b) {
        a = "A, " + a;
        b = "B, " + b;
    }
    Report report;
    tellVerdict(run, a, b, report);
    tellInputs(run, report);
    tellOptions(run, report);
    report.tables = {distanceTable(run), surfaceTable(run)};
    report.warnings = linesOf(run.warnings);
    tellStrict(report, run.options.common, run.warnings, "");
    if (run.overlap) {
        report.notes.push_back("As solids: Dice " + formatFixed(run.overlap->voxels.dice(), 4) +
                               ", mean offset of the boundary " +
                               formatLength(run.overlap->meanBoundaryOffsetMm, 4) + " mm.");
    }
    if (run.frame == CoordinateFrame::TkRas) report.frame = "FreeSurfer's tkRAS mm";
    if (!run.frame) report.frame = kUnsaidFrame;
    const auto& limit = run.options.maxHausdorffMm;
    const auto fails = [&](const DistanceStatistics& s) { return limit && s.maxMm > *limit; };
    report.spots.push_back(farthest(run.distances.aToB, a, b, fails(run.distances.aToB)));
    if (run.options.isSymmetric) {
        report.spots.push_back(farthest(run.distances.bToA, b, a, fails(run.distances.bToA)));
    }
    std::stable_partition(report.spots.begin(), report.spots.end(),
                          [](const ReportSpot& spot) { return spot.isFailure; });
    report.surfaces.push_back({a, std::move(shown.a), std::move(shown.aToBMm)});
    report.surfaces.push_back({b, std::move(shown.b), std::move(shown.bToAMm)});
    if (run.image) report.volume = ReportVolume{baseName(run.options.volume), run.image->view()};
    return report;
}

}  // namespace adaptiso::compare
