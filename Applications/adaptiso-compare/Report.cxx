#include <algorithm>
#include <cctype>
#include <iomanip>
#include <ostream>
#include <string>
#include <string_view>

#include "Common/CommonFrame.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"

namespace adaptiso::compare {
namespace {

Json surfaceJson(const SurfaceSummary& surface) {
    return sizeJson(surface, {{"file", baseName(surface.file)},
                              {"format", surface.format->name},
                              {"coordinates", frameJson(surface.frame)}});
}

Json volumeJson(const CompareRun& run) {
    if (!run.volume) return nullptr;
    return {{"file", baseName(run.options.volume)},
            {"format", run.volume->format},
            {"sizeVoxels", run.volume->geometry.size},
            {"spacingMm", vector(run.volume->geometry.spacingMm())}};
}

Json optionsJson(const CompareOptions& options) {
    return {{"inputCoordinates", inputCoordinatesJson(options.inputCoordinates)},
            {"samples", options.samples},
            {"symmetric", options.isSymmetric},
            {"threads", orNull(options.common.threads)},
            {"strict", options.common.isStrict}};
}

Json distancesJson(const CompareRun& run, const DistanceStatistics& distances,
                   const HausdorffInterval& hausdorff) {
    Json json = distanceJson(distances, run.toFrame);
    json["hausdorff"] = hausdorffJson(hausdorff, run.toFrame);
    json["inVoxels"] = run.voxelMm ? lengthsJson(distances, *run.voxelMm, "") : Json(nullptr);
    json["percentOfDiagonal"] = lengthsJson(distances, run.b.diagonalMm / 100, "");
    return json;
}

/// A less B, and in per cent of B.
Json differenceJson(const std::optional<double>& a, const std::optional<double>& b,
                    const std::string& unit) {
    const bool isKnown = a && b;
    return {{unit, isKnown ? number(*a - *b) : Json(nullptr)},
            {"percent", isKnown ? number((*a - *b) / *b * 100) : Json(nullptr)}};
}

Json overlapJson(const std::optional<OverlapSummary>& overlap) {
    if (!overlap) return nullptr;
    return {{"voxelsA", overlap->voxels.voxelsA},
            {"voxelsB", overlap->voxels.voxelsB},
            {"voxelsBoth", overlap->voxels.voxelsBoth},
            {"dice", number(overlap->voxels.dice())},
            {"meanBoundaryOffsetMm", number(overlap->meanBoundaryOffsetMm)}};
}

Json coloredJson(const CompareRun& run) {
    if (!run.colored) return nullptr;
    return {{"file", baseName(run.options.colored)},
            {"maximumMm", number(run.colored->maximumMm)},
            {"bytes", run.colored->bytes}};
}

Json checksJson(const std::vector<Check>& checks) {
    Json list = Json::array();
    for (const Check& check : checks) {
        list.push_back({{"name", check.key},
                        {"limitMm", number(check.limitMm)},
                        {"valueMm", number(check.valueMm)},
                        {"passed", check.hasPassed()}});
    }
    return list;
}

std::string signedPercent(double value, double of) {
    const double percent = (value - of) / of * 100;
    return (percent > 0 ? "+" : "") + formatFixed(percent, 3) + " %";
}

void printSurface(std::ostream& out, std::string_view name, const SurfaceSummary& surface) {
    out << name << "  " << oneLine(surface.file.string()) << ": " << formatCount(surface.triangles)
        << " triangles, area " << formatMeasure(surface.areaMm2) << " mm2, ";
    if (surface.volumeMm3) {
        out << "volume " << formatMeasure(*surface.volumeMm3) << " mm3\n";
    } else {
        out << "not closed\n";
    }
}

using Length = double DistanceStatistics::*;

/// One row of the table: the same figure of every direction.
void printRow(std::ostream& out, std::string_view name, Length length, double unit,
              const DistanceReport& distances) {
    out << "  " << std::left << std::setw(24) << name << std::right;
    for (const DistanceStatistics* direction :
         {&distances.aToB, &distances.bToA, &distances.combined}) {
        if (direction->samples == 0) continue;
        out << std::setw(12) << formatLength(direction->*length / unit, 4);
        if (distances.bToA.samples == 0) break;  // the combined figures are those of A to B
    }
    out << '\n';
}

/// The row of what no point exceeds.
void printBound(std::ostream& out, std::string_view unitName, double unit,
                const HausdorffReport& hausdorff) {
    out << "  " << std::left << std::setw(24) << "proved at most, " + std::string(unitName)
        << std::right << std::setw(12) << formatBound(hausdorff.aToB.upperMm / unit);
    if (hausdorff.bToA) {
        out << std::setw(12) << formatBound(hausdorff.bToA->upperMm / unit) << std::setw(12)
            << formatBound(hausdorff.combined.upperMm / unit);
    }
    out << '\n';
}

void printLengths(std::ostream& out, const std::string& unitName, double unit,
                  const CompareRun& run) {
    for (const LengthFigure& row : lengthFigures()) {
        printRow(out, std::string(row.label) + ", " + unitName, row.lengthMm, unit, run.distances);
    }
    printBound(out, unitName, unit, run.hausdorff);
}

void printDistances(std::ostream& out, const CompareRun& run) {
    const DistanceReport& distances = run.distances;
    out << "  distance" << std::setw(28) << "A to B";
    if (run.options.isSymmetric) out << std::setw(12) << "B to A" << std::setw(12) << "both";
    out << '\n';
    printLengths(out, "mm", 1, run);
    if (run.voxelMm) printLengths(out, "voxels", *run.voxelMm, run);
    const double percentMm = run.b.diagonalMm / 100;
    printRow(out, "mean, % of diagonal", &DistanceStatistics::meanMm, percentMm, distances);
    printRow(out, "largest, % of diagonal", &DistanceStatistics::maxMm, percentMm, distances);
    printRow(out, "normals, mean degrees", &DistanceStatistics::meanNormalDeviationDeg, 1,
             distances);
    printRow(out, "normals, 95 % within", &DistanceStatistics::p95NormalDeviationDeg, 1, distances);
    const auto place = [&](const Vec3& pointMm) {
        const Vec3 p = run.toFrame(pointMm);
        return formatFixed(p.x, 2) + ", " + formatFixed(p.y, 2) + ", " + formatFixed(p.z, 2);
    };
    const HausdorffInterval& hausdorff = run.hausdorff.combined;
    out << "  farthest known, " << formatLength(hausdorff.lowerMm, 4) << " mm, at "
        << place(hausdorff.pointMm) << ", from " << place(hausdorff.nearestMm) << " ("
        << frameText(run.frame) << ")\n";
}

void printDifferences(std::ostream& out, const CompareRun& run) {
    out << "  area of A " << signedPercent(run.a.areaMm2, run.b.areaMm2);
    if (run.a.volumeMm3 && run.b.volumeMm3) {
        out << ", volume of A " << signedPercent(*run.a.volumeMm3, *run.b.volumeMm3);
    }
    out << " against B\n";
    if (run.overlap) {
        out << "  Dice " << formatFixed(run.overlap->voxels.dice(), 5) << ", mean boundary offset "
            << formatLength(run.overlap->meanBoundaryOffsetMm, 4) << " mm\n";
    }
}

void addVerdict(const CompareRun& run, const std::string& a, const std::string& b, Report& report) {
    const DistanceStatistics& distances = run.distances.combined;
    report.title = "Distance between " + a + " and " + b;
    report.headline = formatLength(distances.meanMm, 3) + " mm on the mean, " +
                      formatFixed(distances.p95Mm, 3) + " mm at 95 %, " +
                      formatBound(run.hausdorff.combined.upperMm, 3) + " mm at most (proved).";
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

void addInputs(const CompareRun& run, Report& report) {
    report.inputs = {{"A", fileText(run.a.file, *run.a.format, run.a.frame)},
                     {"B, the reference", fileText(run.b.file, *run.b.format, run.b.frame)}};
    if (!run.volume) return;
    const std::vector<ReportFact> facts =
        imageFacts(baseName(run.options.volume), run.volume->format, run.volume->geometry);
    report.inputs.insert(report.inputs.end(), facts.begin(), facts.end());
}

void addOptions(const CompareRun& run, Report& report) {
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
    ReportTable table{"Distances, mm", {"Direction"}, {}};
    for (const LengthFigure& row : lengthFigures()) {
        std::string& column = table.columns.emplace_back(row.label);
        column.front() = static_cast<char>(std::toupper(column.front()));
    }
    table.columns.emplace_back("Proved at most");
    table.columns.emplace_back("Angle between the surfaces, mean");
    const auto add = [&](const std::string& name, const DistanceStatistics& statistics,
                         const HausdorffInterval& hausdorff) {
        std::vector<std::string>& cells = table.rows.emplace_back();
        cells.push_back(name);
        for (const LengthFigure& row : lengthFigures()) {
            cells.push_back(formatLength(statistics.*row.lengthMm, 4));
        }
        cells.push_back(formatBound(hausdorff.upperMm));
        cells.push_back(formatFixed(statistics.meanNormalDeviationDeg, 2) + "°");
    };
    add("A to B", run.distances.aToB, run.hausdorff.aToB);
    if (run.hausdorff.bToA) {
        add("B to A", run.distances.bToA, *run.hausdorff.bToA);
        add("both", run.distances.combined, run.hausdorff.combined);
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

ReportSpot farthest(const HausdorffInterval& hausdorff, const std::string& from,
                    const std::string& to, const std::optional<double>& limitMm) {
    return {"farthest point of " + from + " from " + to + ", " +
                formatLength(hausdorff.lowerMm, 3) + " mm",
            hausdorff.pointMm, limitMm && hausdorff.upperMm > *limitMm};
}

}  // namespace

std::string jsonReport(const CompareRun& run) {
    const DistanceReport& distances = run.distances;
    return run.json(
        "adaptiso-compare/1",
        {{"a", surfaceJson(run.a)},
         {"b", surfaceJson(run.b)},
         {"volume", volumeJson(run)},
         {"options", optionsJson(run.options)},
         {"coordinates", frameJson(run.frame)},
         {"voxelMm", orNull(run.voxelMm)},
         {"distances",
          {{"aToB", distancesJson(run, distances.aToB, run.hausdorff.aToB)},
           {"bToA", run.hausdorff.bToA ? distancesJson(run, distances.bToA, *run.hausdorff.bToA)
                                       : Json(nullptr)},
           {"combined", distancesJson(run, distances.combined, run.hausdorff.combined)}}},
         {"differences",
          {{"area", differenceJson(run.a.areaMm2, run.b.areaMm2, "mm2")},
           {"volume", differenceJson(run.a.volumeMm3, run.b.volumeMm3, "mm3")}}},
         {"overlap", overlapJson(run.overlap)},
         {"colored", coloredJson(run)},
         {"checks", checksJson(run.checks)}});
}

void printReport(std::ostream& out, const CompareRun& run) {
    printSurface(out, "A", run.a);
    printSurface(out, "B", run.b);
    printDistances(out, run);
    printDifferences(out, run);
    if (run.colored) {
        out << run.options.colored.string() << ": A with its distances, viridis from 0 to "
            << formatLength(run.colored->maximumMm, 4) << " mm\n";
    }
    printTimes(out, run.timer);
}

Report makeReport(const CompareRun& run, ShownSurfaces& shown) {
    std::string a = baseName(run.a.file), b = baseName(run.b.file);
    if (a == b) {
        a = "A, " + a;
        b = "B, " + b;
    }
    Report report;
    addVerdict(run, a, b, report);
    addInputs(run, report);
    addOptions(run, report);
    report.tables = {distanceTable(run), surfaceTable(run)};
    if (run.overlap) {
        report.notes.push_back("As solids: Dice " + formatFixed(run.overlap->voxels.dice(), 4) +
                               ", mean offset of the boundary " +
                               formatLength(run.overlap->meanBoundaryOffsetMm, 4) + " mm.");
    }
    if (run.frame == CoordinateFrame::TkRas) report.frame = "FreeSurfer's tkRAS mm";
    if (!run.frame) report.frame = kUnsaidFrame;
    const auto& limit = run.options.maxHausdorffMm;
    report.spots.push_back(farthest(run.hausdorff.aToB, a, b, limit));
    if (run.hausdorff.bToA) report.spots.push_back(farthest(*run.hausdorff.bToA, b, a, limit));
    std::stable_partition(report.spots.begin(), report.spots.end(),
                          [](const ReportSpot& spot) { return spot.isFailure; });
    report.valuesAre = "from the other surface";
    report.surfaces.push_back({a, std::move(shown.a), std::move(shown.aToBMm)});
    report.surfaces.push_back({b, std::move(shown.b), std::move(shown.bToAMm)});
    if (run.image) report.volume = ReportVolume{baseName(run.options.volume), run.image->view()};
    return report;
}

}  // namespace adaptiso::compare
