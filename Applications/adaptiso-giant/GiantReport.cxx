#include "Steps.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::giant {
namespace {

constexpr std::size_t kMostRows = 50;  // components in the page's table

std::vector<ReportFact> inputsOf(const GiantPlan& plan, const Json& json) {
    const Index3& size = plan.geometry.size;
    const Vec3 spacing = plan.geometry.spacingMm();
    return {
        {"image", json.at("input").at("file").get<std::string>() + ", " + plan.format},
        {"size", formatCount(size[0]) + " x " + formatCount(size[1]) + " x " +
                     formatCount(size[2]) + " voxels, " + std::string(toString(plan.pixelType))},
        {"spacing", formatShort(spacing.x) + " x " + formatShort(spacing.y) + " x " +
                        formatShort(spacing.z) + " mm"}};
}

std::vector<ReportFact> optionsOf(const GiantPlan& plan) {
    std::vector<ReportFact> facts{{"isovalue", formatNumber(plan.isovalue)},
                                  {"method", std::string(toString(plan.method))},
                                  {"tiles", std::to_string(plan.side) + " cells a side"}};
    if (plan.isAdaptive()) facts.emplace_back("bound", formatShort(plan.maxErrorMm) + " mm");
    return facts;
}

std::vector<ReportCheck> checksOf(const GiantPlan& plan, const GiantSurface& surface) {
    std::vector<ReportCheck> checks{{"the surface", "closed over all pieces", ReportOutcome::Passed,
                                     "every edge on a border has found its partner"}};
    if (plan.isAdaptive()) {
        checks.push_back({"the surface", "within the bound", ReportOutcome::Passed,
                          formatShort(surface.errorBoundMm) + " mm proved, both ways"});
    }
    return checks;
}

ReportTable totalsOf(const GiantSurface& surface, const Json& json) {
    const auto measure = [&](const char* key) { return formatShort(json.at(key).get<double>()); };
    return {"The whole surface",
            {"", ""},
            {{"triangles", formatCount(surface.triangles)},
             {"vertices", formatCount(surface.vertices)},
             {"components", formatCount(surface.totals.count)},
             {"of them cavities", formatCount(json.at("cavities").get<long long>())},
             {"genus", formatCount(json.at("genus").get<long long>())},
             {"area, mm2", measure("areaMm2")},
             {"volume, mm3", measure("volumeMm3")},
             {"pieces", formatCount(surface.pieces)},
             {"pieces left as they were", formatCount(surface.unchangedPieces)}}};
}

ReportTable componentsOf(const GiantSurface& surface) {
    ReportTable table{
        "The largest components", {"", "volume, mm3", "area, mm2", "triangles", "genus"}, {}};
    for (const GiantComponent& component : surface.components) {
        if (table.rows.size() == kMostRows) break;
        table.rows.push_back({std::to_string(table.rows.size() + 1),
                              formatShort(component.volumeMm3), formatShort(component.areaMm2),
                              formatCount(component.triangles), formatCount(component.genus())});
    }
    return table;
}

}  // namespace

Report giantReport(const GiantPlan& plan, const GiantSurface& surface, const Json& json,
                   TriangleMesh coarse) {
    Report report;
    report.title = "Surface of a large volume";
    report.verdict = ReportVerdict::Passed;
    report.headline = formatCount(surface.triangles) + " triangles in " +
                      formatCount(surface.totals.count) + " components, closed";
    report.inputs = inputsOf(plan, json);
    report.options = optionsOf(plan);
    report.checks = checksOf(plan, surface);
    report.tables = {totalsOf(surface, json), componentsOf(surface)};
    report.warnings = linesOf(plan.warnings);
    report.notes.push_back("shown is a coarse copy of " +
                           formatCount(std::ssize(coarse.triangles)) +
                           " triangles, which may cross; all numbers are those of the surface");
    report.surfaces.push_back({"a coarse copy", std::move(coarse)});
    return report;
}

}  // namespace adaptiso::giant
