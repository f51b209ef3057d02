#include "JsonReport.h"

#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/Warnings.h"
#include "adaptiso/SurfaceChecks/DistanceJson.h"

namespace adaptiso::compare {
namespace {

Json surfaceJson(const SurfaceSummary& surface) {
    return {{"file", baseName(surface.file)},
            {"format", surface.format->name},
            {"coordinates", frameJson(surface.frame)},
            {"triangles", surface.triangles},
            {"vertices", surface.vertices},
            {"areaMm2", number(surface.areaMm2)},
            {"volumeMm3", orNull(surface.volumeMm3)},
            {"boundingBoxDiagonalMm", number(surface.diagonalMm)}};
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

/// The lengths in another unit of `unitMm`.
Json lengthsJson(const DistanceStatistics& distances, double unitMm) {
    return {{"mean", number(distances.meanMm / unitMm)},
            {"rms", number(distances.rmsMm / unitMm)},
            {"p95", number(distances.p95Mm / unitMm)},
            {"p99", number(distances.p99Mm / unitMm)},
            {"max", number(distances.maxMm / unitMm)}};
}

Json distancesJson(const CompareRun& run, const DistanceStatistics& distances) {
    if (distances.samples == 0) return nullptr;
    Json json = distanceJson(distances, run.toFrame);
    json["inVoxels"] = run.voxelMm ? lengthsJson(distances, *run.voxelMm) : Json(nullptr);
    json["percentOfDiagonal"] = lengthsJson(distances, run.b.diagonalMm / 100);
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

}  // namespace

std::string jsonReport(const CompareRun& run) {
    const DistanceReport& distances = run.distances;
    Json report = reportHead("adaptiso-compare/1", "adaptiso-compare", run.verdict, run.warnings);
    report.update(Json{{"a", surfaceJson(run.a)},
                       {"b", surfaceJson(run.b)},
                       {"volume", volumeJson(run)},
                       {"options", optionsJson(run.options)},
                       {"coordinates", frameJson(run.frame)},
                       {"voxelMm", orNull(run.voxelMm)},
                       {"distances",
                        {{"aToB", distancesJson(run, distances.aToB)},
                         {"bToA", distancesJson(run, distances.bToA)},
                         {"combined", distancesJson(run, distances.combined)}}},
                       {"differences",
                        {{"area", differenceJson(run.a.areaMm2, run.b.areaMm2, "mm2")},
                         {"volume", differenceJson(run.a.volumeMm3, run.b.volumeMm3, "mm3")}}},
                       {"overlap", overlapJson(run.overlap)},
                       {"colored", coloredJson(run)},
                       {"checks", checksJson(run.checks)},
                       {"failedByWarnings", failsStrict(run.options.common, run.warnings)},
                       {"reportFailure", reportFailureJson(run.verdict.reportFailure)},
                       {"seconds", secondsJson(run.timer)},
                       {"peakMemoryMb", peakMemoryMb()}});
    return jsonText(report) + "\n";
}

}  // namespace adaptiso::compare
