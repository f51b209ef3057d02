#include "JsonReport.h"

#include <algorithm>
#include <numeric>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/Warnings.h"

namespace adaptiso {
namespace {

constexpr std::size_t kMaxComponents = 100;

Json frameJson(const std::optional<CoordinateFrame>& frame) {
    return frame ? Json(frameWord(*frame)) : Json(nullptr);
}

std::string_view outcomeWord(Outcome outcome) {
    switch (outcome) {
        case Outcome::Passed:
            return "passed";
        case Outcome::Failed:
            return "failed";
        case Outcome::Undecided:
            return "undecided";
    }
    throw InternalError("outcomeWord: unknown outcome");
}

Json checksJson(const std::vector<Check>& checks) {
    Json list = Json::array();
    for (const Check& check : checks) {
        list.push_back({{"name", check.key},
                        {"required", check.isRequired},
                        {"outcome", outcomeWord(check.outcome)},
                        {"finding", check.finding}});
    }
    return list;
}

/// Names of the checks that are required and failed.
Json failedJson(const std::vector<Check>& checks) {
    Json list = Json::array();
    for (const Check& check : checks) {
        if (check.breaksProfile()) list.push_back(check.key);
    }
    return list;
}

/// "boundary edge" -> "boundaryEdges"
std::string defectKey(TopologyDefect defect) {
    std::string key;
    bool startsWord = false;
    for (const char c : toString(defect)) {
        if (c == ' ' || c == '-') {
            startsWord = true;
            continue;
        }
        key += startsWord && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        startsWord = false;
    }
    return key;
}

Json defectsJson(const SurfaceFacts& facts) {
    Json counts = Json::object();
    for (int n = 0; n < kTopologyDefectCount; ++n) {
        const auto defect = static_cast<TopologyDefect>(n);
        if (defect == TopologyDefect::DuplicateTriangle) continue;  // by place, below
        counts[defectKey(defect)] = facts.topology.count(defect);
    }
    counts["repeatedIndexTriangle"] = facts.repeatedIndexTriangles;
    counts["duplicateTriangle"] = facts.duplicates.triangleCount;
    counts["duplicateVertex"] = facts.duplicates.vertexCount;
    return counts;
}

Json examplesJson(const SurfaceFacts& facts) {
    Json list = Json::array();
    for (const TopologyExample& example : facts.topology.examples) {
        if (example.defect == TopologyDefect::DuplicateTriangle) continue;
        Json vertices = Json::array();
        for (const VertexId v : example.vertices) {
            if (v != -1) vertices.push_back(v);
        }
        list.push_back({{"defect", defectKey(example.defect)},
                        {"triangle", example.triangle < 0 ? Json(nullptr) : Json(example.triangle)},
                        {"vertices", vertices},
                        {"pointMm", vector(example.pointMm)}});
    }
    for (const std::int64_t triangle : facts.duplicates.triangles) {
        list.push_back({{"defect", "duplicateTriangle"},
                        {"triangle", triangle},
                        {"vertices", Json::array()},
                        {"pointMm", nullptr}});
    }
    for (const VertexId vertex : facts.duplicates.vertices) {
        list.push_back({{"defect", "duplicateVertex"},
                        {"triangle", nullptr},
                        {"vertices", {vertex}},
                        {"pointMm", nullptr}});
    }
    return list;
}

/// Those with the most triangles, in the mesh's order.
Json componentsJson(const SurfaceFacts& facts) {
    const auto& components = facts.topology.components;
    std::vector<std::size_t> order(components.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
        return components[l].triangles > components[r].triangles;
    });
    if (order.size() > kMaxComponents) order.resize(kMaxComponents);
    std::sort(order.begin(), order.end());
    Json list = Json::array();
    for (const std::size_t n : order) {
        const SurfaceComponent& component = components[n];
        list.push_back({{"component", n},
                        {"firstVertex", component.firstVertex},
                        {"vertices", component.vertices},
                        {"triangles", component.triangles},
                        {"closed", component.isClosed()},
                        {"manifold", component.isManifold},
                        {"oriented", component.isOriented},
                        {"genus", orNull(component.genus())},
                        {"areaMm2", number(component.areaMm2)},
                        {"signedVolumeMm3", component.isClosed() ? number(component.signedVolumeMm3)
                                                                 : Json(nullptr)}});
    }
    return list;
}

Json pairsJson(std::int64_t count, const std::vector<TrianglePair>& pairs) {
    return {{"pairCount", count}, {"pairs", pairs}};
}

Json spreadJson(const Spread& spread) {
    const auto triangle = [](std::int64_t n) { return n < 0 ? Json(nullptr) : Json(n); };
    return {{"minimum", number(spread.minimum)},
            {"p1", number(spread.p1)},
            {"p5", number(spread.p5)},
            {"median", number(spread.median)},
            {"mean", number(spread.mean)},
            {"p99", number(spread.p99)},
            {"maximum", number(spread.maximum)},
            {"triangleOfMinimum", triangle(spread.triangleOfMinimum)},
            {"triangleOfMaximum", triangle(spread.triangleOfMaximum)}};
}

std::string_view sizeWord(SizeVerdict verdict) {
    switch (verdict) {
        case SizeVerdict::Plausible:
            return "plausible";
        case SizeVerdict::TooSmall:
            return "tooSmall";
        case SizeVerdict::TooLarge:
            return "tooLarge";
        case SizeVerdict::Unknown:
            return "unknown";
    }
    throw InternalError("sizeWord: unknown verdict");
}

Json sizeJson(const SizeReport& size) {
    return {{"extentMm", vector(size.extentMm)},
            {"verdict", sizeWord(size.verdict)},
            {"guessedUnit", size.guess ? Json(toString(*size.guess)) : Json(nullptr)}};
}

Json deviationJson(const std::optional<DistanceStatistics>& deviation) {
    if (!deviation) return nullptr;
    return {{"samples", deviation->samples},
            {"meanMm", number(deviation->meanMm)},
            {"rmsMm", number(deviation->rmsMm)},
            {"p95Mm", number(deviation->p95Mm)},
            {"p99Mm", number(deviation->p99Mm)},
            {"maxMm", number(deviation->maxMm)},
            {"maxPointMm", vector(deviation->maxPointMm)}};
}

/// Why a file can't be read, without the folders of its name.
std::string errorText(const SurfaceRun& surface) {
    const std::string path = surface.file.string();
    const bool namesIt = surface.error.starts_with(path);
    return namesIt ? baseName(surface.file) + surface.error.substr(path.size()) : surface.error;
}

Json surfaceJson(const SurfaceRun& surface) {
    if (!surface.error.empty()) {
        return {{"file", baseName(surface.file)}, {"error", errorText(surface)}, {"passed", false}};
    }
    const SurfaceFacts& facts = surface.facts;
    const TopologyReport& topology = facts.topology;
    return {
        {"file", baseName(surface.file)},
        {"error", nullptr},
        {"passed", allHold(surface.checks)},
        {"failed", failedJson(surface.checks)},
        {"checks", checksJson(surface.checks)},
        {"format", surface.format->name},
        {"coordinates", frameJson(surface.frame)},
        {"pointsIn", frameJson(surface.points)},
        {"vertices", topology.vertices},
        {"edges", topology.edges},
        {"triangles", topology.triangles},
        {"genus", orNull(topology.genus())},
        {"areaMm2", number(facts.areaMm2)},
        {"volumeMm3", facts.volumeMm3 ? number(*facts.volumeMm3) : Json(nullptr)},
        {"size", sizeJson(facts.size)},
        {"solidAngleShare", number(facts.solidAngle.share)},
        {"defects", defectsJson(facts)},
        {"examples", examplesJson(facts)},
        {"componentCount", topology.components.size()},
        {"components", componentsJson(facts)},
        {"componentsInsideOut", orNull(facts.insideOut)},
        {"selfIntersections", pairsJson(facts.intersections.pairCount, facts.intersections.pairs)},
        {"shape",
         {{"triangles", facts.shape.triangles},
          {"minAngleDeg", spreadJson(facts.shape.minAngleDeg)},
          {"aspectRatio", spreadJson(facts.shape.aspectRatio)},
          {"edgeMm", spreadJson(facts.shape.edgeMm)}}},
        {"isosurface", deviationJson(surface.deviation)}};
}

Json gapJson(const NestingReport& report, const AffineTransform& toFrame) {
    if (report.gap.triangleA < 0) return nullptr;
    return {{"mm", number(report.gap.nearest.distanceMm)},
            {"innerTriangle", report.gap.triangleA},
            {"outerTriangle", report.gap.triangleB},
            {"innerPointMm", vector(toFrame(report.gap.nearest.pointA))},
            {"outerPointMm", vector(toFrame(report.gap.nearest.pointB))}};
}

Json nestingJson(const CheckRun& run) {
    if (!run.options.isNested) return nullptr;
    Json pairs = Json::array();
    for (const NestingRun& pair : run.nesting) {
        const NestingReport& report = pair.report;
        pairs.push_back({{"inner", baseName(run.surfaces[pair.inner].file)},
                         {"outer", baseName(run.surfaces[pair.outer].file)},
                         {"passed", allHold(pair.checks)},
                         {"failed", failedJson(pair.checks)},
                         {"checks", checksJson(pair.checks)},
                         {"relation", toString(report.relation)},
                         {"crossings", pairsJson(report.crossingPairs, report.pairs)},
                         {"innerVertices", report.innerVertices},
                         {"innerVerticesNotInside", report.innerVerticesNotInside},
                         {"firstNotInside",
                          report.firstNotInside < 0 ? Json(nullptr) : Json(report.firstNotInside)},
                         {"farthestOutMm", number(report.farthestOutMm)},
                         {"outerVertices", report.outerVertices},
                         {"outerVerticesInside", report.outerVerticesInside},
                         {"gap", gapJson(report, run.toNestingFrame)}});
    }
    return {{"pointsIn", frameJson(run.nestingFrame)}, {"pairs", pairs}};
}

Json volumeJson(const CheckRun& run) {
    if (!run.volume) return nullptr;
    return {
        {"file", baseName(run.options.volume)},
        {"format", run.volume->format},
        {"sizeVoxels", run.volume->geometry.size},
        {"spacingMm", vector(run.volume->geometry.spacingMm())},
        {"preprocessing", preprocessingJson(run.options.preprocessing, run.volume->geometry.size)}};
}

Json optionsJson(const CheckOptions& options) {
    return {{"nested", options.isNested},
            {"profile", toString(options.profileInUse())},
            {"iso", orNull(options.isovalue)},
            {"minGapMm", options.minGapMm.value_or(CheckOptions::kDefaultMinGapMm)},
            {"minAngleDeg", options.minAngleDeg.value_or(CheckOptions::kDefaultMinAngleDeg)},
            {"maxOffMm", orNull(options.maxOffMm)},
            {"maxPairs", options.maxPairs},
            {"threads", orNull(options.common.threads)},
            {"strict", options.common.isStrict}};
}

}  // namespace

std::string jsonReport(const CheckRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceRun& surface : run.surfaces) surfaces.push_back(surfaceJson(surface));
    const Json report{{"schema", "adaptiso-check/1"},
                      {"program", {{"name", "adaptiso-check"}, {"version", programVersion()}}},
                      {"passed", run.hasPassed() && !failsStrict(run.options.common, run.warnings)},
                      {"options", optionsJson(run.options)},
                      {"volume", volumeJson(run)},
                      {"surfaces", surfaces},
                      {"nesting", nestingJson(run)},
                      {"plausibility", notesJson(run.notes)},
                      {"warnings", run.warnings},
                      {"failedByWarnings", failsStrict(run.options.common, run.warnings)},
                      {"reportFailure", reportFailureJson(run.reportFailure)},
                      {"seconds", secondsJson(run.timer)},
                      {"peakMemoryMb", peakMemoryMb()}};
    // a file's name need not be UTF-8: what is not becomes U+FFFD
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace adaptiso
