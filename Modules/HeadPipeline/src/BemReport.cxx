#include "adaptiso/HeadPipeline/BemReport.h"

#include <algorithm>
#include <array>

#include "adaptiso/Core/Text.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {
namespace {

std::string pairName(std::size_t inner, std::size_t count) {
    return bemSurfaceName(inner, count) + " in " + bemSurfaceName(inner + 1, count);
}

void addVerdict(const BemModel& model, Report& report) {
    const std::size_t count = model.options.surfaceCount();
    constexpr std::array<const char*, kHeadSurfaceCount> kLayers{
        "one layer", "two layers", "three layers", "four layers", "five layers"};
    report.title = std::string("Head model of ") + kLayers.at(count - 1);
    if (model.hasModel()) {
        report.verdict = ReportVerdict::Passed;
        report.headline =
            "All " + formatCount(std::ssize(model.checks)) +
            " checks hold: every surface is closed, in one piece, of genus 0 and does "
            "not cross itself" +
            (model.gaps.empty() ? "."
                                : "; they lie in each other with the gaps asked "
                                  "for.");
        const std::int64_t notes = notedCount(model.plausibility);
        if (notes > 0) {
            report.headline += " " + formatCount(notes) +
                               (notes == 1 ? " thing is" : " things are") +
                               " unusual of a head model: worth a look.";
        }
    } else {
        report.verdict = ReportVerdict::Failed;
        report.headline = "No model could be guaranteed: " + model.failureText();
    }
}

std::string fileText(const BemInput& input) {
    return input.file.empty() ? input.format : input.file + " (" + input.format + ")";
}

void addInputs(const BemModel& model, Report& report) {
    for (const BemInput& input : model.inputs) {
        report.inputs.push_back({input.role, fileText(input)});
    }
    if (!model.image) return;
    const std::vector<ReportFact> facts = imageFacts("", "", *model.image);
    report.inputs.insert(report.inputs.end(), facts.begin() + 1, facts.end());
}

void addOptions(const BemModel& model, Report& report) {
    const BemModelOptions& options = model.options;
    const BoundaryOptions& head = options.boundaries;
    std::string triangles =
        model.source == BemSource::Surfaces ? "as the surfaces came, where they could stay"
        : head.innerSurfaces > 0            ? "by the layers' thickness, 10,000 vertices at most"
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
    report.options = {{"Made from", toString(model.source)}, {"Triangles", triangles}};
    if (options.surfaceCount() > 1) {
        report.options.push_back(
            {"Skull, scalp at least",
             formatNumber(head.minSkullMm) + " mm, " + formatNumber(head.minScalpMm) + " mm"});
    }
    if (head.innerSurfaces > 0) {
        report.options.push_back({"CSF at least", formatNumber(head.minCsfMm) + " mm"});
    }
    if (head.innerSurfaces > 1) {
        report.options.push_back({"Grey matter at least", formatNumber(head.minGreyMm) + " mm"});
    }
    report.options.push_back({"Smoothing", formatNumber(head.smoothingMm) + " mm"});
    const ConductivityModel& sigma = options.conductivities;
    report.options.push_back(
        {"Conductivity",
         (head.innerSurfaces > 1 ? "white matter " + formatNumber(sigma.white) + ", grey matter "
                                 : "brain ") +
             formatNumber(sigma.brain) +
             (head.innerSurfaces > 0 ? ", CSF " + formatNumber(sigma.csf) : "") + ", skull " +
             formatNumber(sigma.skull) + ", scalp " + formatNumber(sigma.scalp) + " S/m"});
    report.options.push_back(
        {"FreeSurfer's files in", model.tkRasVolume ? "tkRAS mm" : "scanner RAS mm"});
}

void addChecks(const BemModel& model, Report& report) {
    for (const BemCheck& check : model.checks) {
        report.checks.push_back({check.subject, check.name,
                                 check.isPassed ? ReportOutcome::Passed : ReportOutcome::Failed,
                                 check.detail});
    }
}

void addSpots(const BemModel& model, Report& report) {
    for (const Finding& finding : model.findings) {
        report.spots.push_back({finding.what, finding.pointMm});
    }
    for (const Finding& doubt : model.doubts) {
        report.spots.push_back({doubt.what, doubt.pointMm, false});
    }
    for (std::size_t n = 0; n < model.gaps.size(); ++n) {
        const NestedGap& gap = model.gaps[n];
        report.spots.push_back({"smallest gap, " + formatFixed(gap.mm, 2) + " mm, of " +
                                    pairName(n, model.meshes.size()),
                                gap.innerPointMm, false});
    }
}

ReportTable surfaceTable(const BemModel& model) {
    ReportTable table{"Surfaces",
                      {"Surface", "Vertices", "Triangles", "Area, cm²", "Volume, cm³", "Edges, mm",
                       "Smallest angle", "From the dense surface, mm (mean, most)",
                       "Moved to nest, mm", "Seen in the image"},
                      {}};
    for (std::size_t n = 0; n < model.surfaces.size(); ++n) {
        const BemSurface& surface = model.surfaces[n];
        const auto& remesh = surface.remesh;
        table.rows.push_back(
            {bemSurfaceName(n, model.meshes.size()), formatCount(surface.topology.vertices),
             formatCount(surface.topology.triangles), formatRounded(surface.areaMm2 / 100),
             formatRounded(surface.volumeMm3 / 1000),
             formatFixed(surface.shape.edgeMm.minimum, 1) + " to " +
                 formatFixed(surface.shape.edgeMm.maximum, 1),
             formatFixed(surface.shape.angleDeg.minimum, 1) + "°",
             remesh ? formatFixed(remesh->meanVertexDistanceMm, 2) + ", " +
                          formatFixed(remesh->maximumVertexDistanceMm, 2)
                    : "as it came",
             surface.move.movedVertices > 0 ? "up to " + formatFixed(surface.move.maximumMm, 2)
                                            : "–",
             surface.seen ? formatRounded(100 * surface.seen->share) + " % of the area" : "–"});
    }
    return table;
}

ReportTable fileTable(const std::vector<std::pair<std::string, std::uintmax_t>>& files) {
    ReportTable table{"Files written", {"File", "Bytes"}, {}};
    for (const auto& [name, bytes] : files) {
        table.rows.push_back({name, formatCount(static_cast<long long>(bytes))});
    }
    return table;
}

void addMarks(const std::string& name, const std::vector<Vec3>& points, double radiusMm,
              Report& report) {
    report.surfaces.push_back({name, pointMarks(points, radiusMm)});
    report.surfaces.back().areMarks = true;
}

void addElectrodes(const BemModel& model, Report& report) {
    if (!model.electrodes) return;
    const BemElectrodes& placed = *model.electrodes;
    const std::vector<NamedPoint> all = placed.all();
    if (all.empty()) return;
    ReportTable table{"Electrodes and landmarks", {"Name", "x, mm", "y, mm", "z, mm"}, {}};
    const std::vector<double>& uncertainty = placed.uncertaintyMm;
    if (!uncertainty.empty()) table.columns.push_back("may be off by, mm");
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Vec3& p = all[n].point;
        table.rows.push_back(
            {all[n].name, formatFixed(-p.x, 1), formatFixed(-p.y, 1), formatFixed(p.z, 1)});
        if (uncertainty.empty()) continue;
        table.rows.back().push_back(n < uncertainty.size() ? formatFixed(uncertainty[n], 0) : "");
    }
    report.tables.push_back(std::move(table));
    if (placed.landmarks) {
        const Landmarks& l = *placed.landmarks;
        report.options.push_back(
            {"Nasion and ears",
             l.areGuessed() ? "guessed, to " + formatShort(l.nasionUncertaintyMm) + " mm and " +
                                  formatShort(l.earUncertaintyMm) + " mm"
             : placed.landmarkOrigin == "file" ? "as the electrodes' file has them"
                                               : "as given"});
    }
    std::vector<Vec3> points;
    for (const NamedPoint& point : all) points.push_back(point.point);
    addMarks("electrodes and landmarks", points, 3, report);
}

void addSources(const BemModel& model, Report& report) {
    if (!model.sources || model.meshes.empty()) return;
    std::vector<Vec3> points;
    for (const SourceSpace& space : model.sources->spaces) {
        for (const std::int64_t point : space.used) points.push_back(space.surface.points[point]);
    }
    if (!points.empty()) addMarks("sources", points, 1.5, report);
}

}  // namespace

Report bemReport(const BemModel& model,
                 const std::vector<std::pair<std::string, std::uintmax_t>>& files) {
    Report report;
    addVerdict(model, report);
    addInputs(model, report);
    addOptions(model, report);
    addChecks(model, report);
    addSpots(model, report);
    report.warnings = linesOf(model.warnings);
    addNotes(model.plausibility, report);
    if (!model.checks.empty()) report.tables.push_back(surfaceTable(model));
    if (!files.empty()) report.tables.push_back(fileTable(files));
    report.notes = model.notes;
    if (!model.hasModel() && !model.meshes.empty()) {
        report.notes.push_back(
            "The surfaces shown are those that the model was tried from; none was written.");
    }
    report.valuesAre = "from the nearest place that the image shows";
    for (std::size_t n = 0; n < model.meshes.size(); ++n) {
        report.surfaces.push_back({bemSurfaceName(n, model.meshes.size()), model.meshes[n]});
        if (n < model.surfaces.size() && model.surfaces[n].seen) {
            report.surfaces.back().valuesMm = model.surfaces[n].seen->distanceMm;
        }
        report.surfaces.back().isWithinSkull =
            headSurface(n, model.meshes.size()) <= HeadSurface::InnerSkull &&
            model.source != BemSource::Surfaces;
    }
    if (!model.seenMm.empty() && model.hasModel()) {
        report.notes.push_back(
            "Colours: how far a surface lies from the nearest place where the image shows it, up "
            "to " +
            formatShort(kFarFromSeenMm) + " mm; beyond " + formatShort(kSeenWithinMm) +
            " mm it is a guess (closed, filled, cut, or as thick as usual).");
    }
    addElectrodes(model, report);
    addSources(model, report);
    return report;
}

}  // namespace adaptiso
