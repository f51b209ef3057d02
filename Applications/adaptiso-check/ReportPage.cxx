#include "ReportPage.h"

#include <algorithm>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Numbers.h"
#include "Common/ReportOutput.h"
#include "Spots.h"

namespace adaptiso {
namespace {

ReportOutcome outcomeOf(const Check& check) {
    switch (check.outcome) {
        case Outcome::Passed:
            return ReportOutcome::Passed;
        case Outcome::Failed:
            return check.isRequired ? ReportOutcome::Failed : ReportOutcome::Noted;
        case Outcome::Undecided:
            return ReportOutcome::Undecided;
    }
    throw InternalError("outcomeOf: unknown outcome");
}

void addChecks(const std::string& subject, const std::vector<Check>& checks, Report& report) {
    for (const Check& check : checks) {
        report.checks.push_back(
            {subject, std::string(check.name), outcomeOf(check), check.finding});
    }
}

std::string nameOf(const CheckRun& run, std::size_t number) {
    return baseName(run.surfaces[number].file);
}

std::string pairName(const CheckRun& run, const NestingRun& pair) {
    return nameOf(run, pair.inner) + " in " + nameOf(run, pair.outer);
}

void tellVerdict(const CheckRun& run, Report& report) {
    const auto unreadable =
        std::count_if(run.surfaces.begin(), run.surfaces.end(),
                      [](const SurfaceRun& surface) { return !surface.error.empty(); });
    const auto failures = std::count_if(
        report.checks.begin(), report.checks.end(),
        [](const ReportCheck& check) { return check.outcome == ReportOutcome::Failed; });
    const std::string profile(toString(run.options.profileInUse()));
    const std::size_t count = run.surfaces.size();
    report.title = count == 1 ? "Check of " + nameOf(run, 0)
                              : "Check of " + std::to_string(count) +
                                    (run.options.isNested ? " nested surfaces" : " surfaces");
    report.verdict = run.hasPassed() ? ReportVerdict::Passed : ReportVerdict::Failed;
    if (run.hasPassed()) {
        report.headline = "Everything that the profile \"" + profile + "\" requires holds.";
        const std::int64_t notes = notedCount(run.notes);
        if (notes > 0) {
            report.headline += " " + formatCount(notes) +
                               (notes == 1 ? " thing is" : " things are") +
                               " unusual of a head model: worth a look.";
        }
        return;
    }
    if (failures > 0) {
        report.headline = formatCount(failures) + (failures == 1 ? " check" : " checks") +
                          " that the profile \"" + profile + "\" requires failed.";
    }
    if (unreadable > 0) {
        report.headline += std::string(report.headline.empty() ? "" : " ") +
                           formatCount(unreadable) + " of " +
                           formatCount(std::ssize(run.surfaces)) +
                           (count == 1 ? " file" : " files") + " could not be read.";
    }
}

void tellInputs(const CheckRun& run, Report& report) {
    for (const SurfaceRun& surface : run.surfaces) {
        std::string text = baseName(surface.file);
        if (!surface.error.empty()) {
            // the message begins with the whole path
            const std::string path = surface.file.string();
            text += ": " + (surface.error.starts_with(path + ": ")
                                ? surface.error.substr(path.size() + 2)
                                : std::string("could not be read"));
        } else {
            text += " (" + std::string(surface.format->name) + ", " +
                    (surface.frame ? std::string(toString(*surface.frame)) : "frame not said") +
                    ")";
        }
        report.inputs.push_back({"Surface", text});
    }
    if (!run.volume) return;
    const std::vector<ReportFact> facts =
        imageFacts(baseName(run.options.volume), run.volume->format, run.volume->geometry);
    report.inputs.insert(report.inputs.end(), facts.begin(), facts.end());
}

void tellOptions(const CheckRun& run, Report& report) {
    const CheckOptions& options = run.options;
    report.options = {{"Profile", std::string(toString(options.profileInUse()))},
                      {"Nested", options.isNested ? "yes, from inside to outside" : "no"}};
    if (options.isNested) {
        report.options.push_back({"Smallest gap", formatNumber(options.minGapMm.value_or(
                                                      CheckOptions::kDefaultMinGapMm)) +
                                                      " mm or more"});
    }
    const double angleDeg = options.minAngleDeg.value_or(CheckOptions::kDefaultMinAngleDeg);
    report.options.push_back({"Smallest angle", formatNumber(angleDeg) + "° or more"});
    if (options.isovalue) report.options.push_back({"Isovalue", formatNumber(*options.isovalue)});
    if (options.maxOffMm) {
        report.options.push_back(
            {"Farthest from the isosurface", formatNumber(*options.maxOffMm) + " mm"});
    }
}

ReportTable surfaceTable(const CheckRun& run) {
    ReportTable table{"Surfaces",
                      {"Surface", "Triangles", "Vertices", "Pieces", "Genus", "Area, mm²",
                       "Volume, mm³", "Smallest angle", "Median edge, mm"},
                      {}};
    for (const SurfaceRun& surface : run.surfaces) {
        if (!surface.error.empty()) continue;
        const SurfaceFacts& facts = surface.facts;
        const auto genus = facts.topology.genus();
        table.rows.push_back({baseName(surface.file), formatCount(facts.topology.triangles),
                              formatCount(facts.topology.vertices),
                              formatCount(std::ssize(facts.topology.components)),
                              genus ? formatCount(*genus) : "–", formatMeasure(facts.areaMm2),
                              facts.volumeMm3 ? formatMeasure(*facts.volumeMm3) : "–",
                              formatFixed(facts.shape.minAngleDeg.minimum, 2) + "°",
                              formatLength(facts.shape.edgeMm.median, 2)});
    }
    return table;
}

ReportTable nestingTable(const CheckRun& run) {
    ReportTable table{"How they lie in each other",
                      {"Surfaces", "Relation", "Smallest gap, mm", "Crossing pairs"},
                      {}};
    for (const NestingRun& pair : run.nesting) {
        const bool hasGap = pair.report.gap.triangleA >= 0;
        table.rows.push_back({pairName(run, pair), std::string(toString(pair.report.relation)),
                              hasGap ? formatLength(pair.report.gap.nearest.distanceMm, 3) : "–",
                              formatCount(pair.report.crossingPairs)});
    }
    return table;
}

const TriangleMesh* meshOf(const ShownSurfaces& shown, std::size_t number) {
    for (const ShownSurfaces::Shown& surface : shown.surfaces) {
        if (surface.number == number) return &surface.mesh;
    }
    return nullptr;
}

void tellSpots(const CheckRun& run, const ShownSurfaces& shown, Report& report) {
    const auto add = [&](const std::vector<ReportSpot>& spots) {
        report.spots.insert(report.spots.end(), spots.begin(), spots.end());
    };
    for (const NestingRun& pair : run.nesting) {
        const TriangleMesh *inner = meshOf(shown, pair.inner), *outer = meshOf(shown, pair.outer);
        if (!inner || !outer) continue;
        add(spotsOf(pair, nameOf(run, pair.inner), nameOf(run, pair.outer), *inner, *outer));
    }
    for (const ShownSurfaces::Shown& surface : shown.surfaces) {
        add(spotsOf(run.surfaces[surface.number], surface.mesh));
    }
    // what fails first, and of that one of every kind
    std::stable_sort(report.spots.begin(), report.spots.end(),
                     [](const ReportSpot& a, const ReportSpot& b) {
                         return std::pair(!a.isFailure, a.rank) < std::pair(!b.isFailure, b.rank);
                     });
}

}  // namespace

Report makeReport(const CheckRun& run, ShownSurfaces& shown) {
    Report report;
    for (const NestingRun& pair : run.nesting) addChecks(pairName(run, pair), pair.checks, report);
    for (const SurfaceRun& surface : run.surfaces) {
        addChecks(baseName(surface.file), surface.checks, report);
    }
    addNotes(run.notes, report);
    tellVerdict(run, report);
    tellInputs(run, report);
    tellOptions(run, report);
    report.tables.push_back(surfaceTable(run));
    if (!run.nesting.empty()) report.tables.push_back(nestingTable(run));
    tellSpots(run, shown, report);
    tellStrict(report, run.options.common, run.warnings, "");
    report.warnings = linesOf(run.warnings);
    for (const SurfaceRun& surface : run.surfaces) {
        if (!surface.points || surface.points == CoordinateFrame::Ras) continue;
        report.notes.push_back(
            "Points in the table of checks are as the files have them, those of " +
            baseName(surface.file) + " in " + std::string(toString(*surface.points)) + ".");
    }
    for (const std::string& note : shown.notes) {
        if (std::find(report.warnings.begin(), report.warnings.end(), note) ==
            report.warnings.end()) {
            report.notes.push_back(note);
        }
    }
    if (shown.frame == CoordinateFrame::TkRas) report.frame = "FreeSurfer's tkRAS mm";
    if (!shown.frame) report.frame = kUnsaidFrame;
    for (ShownSurfaces::Shown& surface : shown.surfaces) {
        report.surfaces.push_back({nameOf(run, surface.number), std::move(surface.mesh), {}});
    }
    if (shown.image) {
        report.volume = ReportVolume{baseName(run.options.volume), shown.image->volume.view()};
    }
    return report;
}

}  // namespace adaptiso
