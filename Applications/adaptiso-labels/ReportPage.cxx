#include <algorithm>

#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Regions.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::labels {
namespace {

/// More regions than that make a page slow to open; the largest are shown.
constexpr std::size_t kMostShown = 2000;

/// A region's colour, lightened if too dark for the page's black background.
ReportColor onBlack(const LabelColor& color) {
    constexpr std::uint8_t kDark = 70;
    if (std::ranges::max(color) >= kDark) return color;
    ReportColor lighter{};
    for (std::size_t n = 0; n < 3; ++n) {
        lighter[n] = static_cast<std::uint8_t>(color[n] + kDark);
    }
    return lighter;
}

void addVerdict(const LabelsRun& run, Report& report) {
    const std::size_t count = run.regions.size();
    report.title = formatCount(static_cast<std::int64_t>(count)) +
                   (count == 1 ? " region of " : " regions of ") + baseName(run.options.input);
    if (run.holdsPromises()) {
        report.headline =
            "Written: each region closed, outward and manifold; neighbours share one wall; no "
            "triangle crosses another; every voxel centre lies in the region of its label.";
        return;
    }
    report.verdict = ReportVerdict::Failed;
    report.headline = "Not written: the walls do not keep what is promised of them.";
}

void addInputs(const LabelsRun& run, Report& report) {
    const MapSummary& map = run.map;
    report.inputs = imageFacts(baseName(run.options.input), map.format, map.geometry);
    report.inputs.push_back(
        {"Labels", formatCount(map.labels) + " (" + std::string(toString(map.pixelType)) + ")"});
    std::string names;
    for (const std::string& file : run.names.files) names += (names.empty() ? "" : ", ") + file;
    report.inputs.push_back(
        {"Names", names.empty() ? "none found" : names + " (" + run.names.format + ")"});
}

void addOptions(const LabelsRun& run, Report& report) {
    const LabelsOptions& options = run.options;
    const auto add = [&](const std::string& name, const std::string& value) {
        report.options.push_back({name, value});
    };
    if (!options.labels.empty()) {
        std::string list;
        for (const LabelRange& range : options.labels) {
            list += (list.empty() ? "" : ", ") + toText(range);
        }
        add("Regions asked for", list);
    }
    for (const LabelMerge& merge : options.merges) {
        std::string list;
        for (const LabelRange& range : merge.labels) {
            list += (list.empty() ? "" : ", ") + toText(range);
        }
        add("Merged", merge.name + " = " + list);
    }
    const LabelStatistics& statistics = run.statistics;
    add("Triangles", formatCount(run.triangles) + " in walls stored once; " +
                         (run.isPart() ? "whole map " + formatCount(statistics.mapTriangles) +
                                             ", at full resolution "
                                       : "full resolution ") +
                         formatCount(statistics.fullTriangles));
    add("Distance to the full resolution",
        run.errorBoundMm() > 0
            ? "at most " + formatBound(run.errorBoundMm()) + " mm, both ways (proved)"
            : "none, these are its walls");
    add("Format, frame", std::string(run.format->name) + ", " + std::string(toString(run.frame)));
}

void addFindings(const LabelsRun& run, Report& report) {
    for (const LabelsCheck& check : run.checks) {
        report.checks.push_back({"all walls", check.name,
                                 check.isPassed ? ReportOutcome::Passed : ReportOutcome::Failed,
                                 check.finding});
        for (std::size_t n = 0; n < check.pointsMm.size(); ++n) {
            report.spots.push_back(
                {"not so: " + check.name, check.pointsMm[n], true, static_cast<int>(n)});
        }
    }
}

/// Whom a region meets most, by area.
std::string neighboursText(const LabelsRun& run, const Region& region) {
    constexpr std::size_t kMost = 4;
    std::vector<RegionContact> contacts = region.measure.neighbours;
    std::ranges::stable_sort(contacts, std::ranges::greater{}, &RegionContact::areaMm2);
    std::string text;
    for (std::size_t n = 0; n < std::min(contacts.size(), kMost); ++n) {
        text += (n == 0 ? "" : ", ") + run.nameOf(contacts[n].label) + " " +
                formatMeasure(contacts[n].areaMm2);
    }
    const std::size_t more = contacts.size() - std::min(contacts.size(), kMost);
    return more == 0 ? text : text + ", " + std::to_string(more) + " more";
}

ReportTable regionTable(const LabelsRun& run, const std::vector<std::size_t>& shown) {
    ReportTable table{"Regions",
                      {"Region", "Label", "Voxels", "Volume, mm³", "Area, mm²", "Triangles",
                       "Pieces", "Euler", "Neighbours, and the area shared, mm²"},
                      {}};
    for (const std::size_t n : shown) {
        const Region& region = run.regions[n];
        const RegionMeasure& measure = region.measure;
        table.rows.push_back({region.name, std::to_string(region.label), formatCount(region.voxels),
                              formatMeasure(measure.volumeMm3), formatMeasure(measure.areaMm2),
                              formatCount(measure.triangles), formatCount(measure.components),
                              std::to_string(measure.eulerCharacteristic),
                              neighboursText(run, region)});
    }
    return table;
}

/// The regions that are shown, by label.
std::vector<std::size_t> chooseShown(const LabelsRun& run, Report& report) {
    std::vector<std::size_t> shown(run.regions.size());
    for (std::size_t n = 0; n < shown.size(); ++n) shown[n] = n;
    if (shown.size() <= kMostShown) return shown;
    std::ranges::stable_sort(shown, std::ranges::greater{},
                             [&](std::size_t n) { return run.regions[n].voxels; });
    shown.resize(kMostShown);
    std::ranges::sort(shown);
    report.notes.push_back("The page shows the " + formatCount(kMostShown) + " largest of " +
                           formatCount(std::ssize(run.regions)) +
                           " regions; all are in the folder and in regions.tsv.");
    return shown;
}

}  // namespace

Report makeReport(const LabelsRun& run, const RegionSurfaces& surfaces,
                  const std::string& volumeName, const VolumeView& volume) {
    Report report;
    report.areRegions = true;
    addVerdict(run, report);
    addInputs(run, report);
    addOptions(run, report);
    addFindings(run, report);
    const std::vector<std::size_t> shown = chooseShown(run, report);
    for (const std::size_t n : shown) {
        ReportSurface surface{run.nameOf(run.regions[n].label), surfaces.surface(n)};
        surface.color = onBlack(run.regions[n].color);
        report.surfaces.push_back(std::move(surface));
    }
    report.tables.push_back(regionTable(run, shown));
    report.volume = ReportVolume{volumeName, volume};
    return report;
}

}  // namespace adaptiso::labels
