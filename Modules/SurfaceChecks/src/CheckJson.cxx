#include "adaptiso/SurfaceChecks/CheckJson.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace {

constexpr std::size_t kMaxComponents = 100;

std::string_view outcomeWord(Outcome outcome) {
    constexpr const char* kWords[] = {"passed", "failed", "undecided"};
    return kWords[static_cast<std::size_t>(outcome)];
}

Json checksJson(const std::vector<Check>& checks) {
    Json list = Json::array();
    for (const Check& check : checks) {
        list.push_back({{"name", check.key},
                        {"text", check.name},
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
    constexpr std::size_t kMostCrossings = 10;
    const auto& pairs = facts.intersections.pairs;
    for (std::size_t n = 0; n < std::min(pairs.size(), kMostCrossings); ++n) {
        list.push_back({{"defect", "crossing"},
                        {"triangle", pairs[n][0]},
                        {"vertices", Json::array()},
                        {"pointMm", n == 0 ? vector(facts.firstCrossingMm) : Json(nullptr)}});
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

Json pairsJson(std::int64_t count, bool isComplete, const std::vector<TrianglePair>& pairs) {
    return {{"pairCount", count}, {"isComplete", isComplete}, {"pairs", pairs}};
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
    constexpr const char* kWords[] = {"plausible", "tooSmall", "tooLarge", "unknown"};
    return kWords[static_cast<std::size_t>(verdict)];
}

Json wallsJson(const std::optional<WallReport>& walls) {
    if (!walls || !walls->hasWall()) return nullptr;
    return {{"leastMm", number(walls->leastMm)},
            {"triangle", walls->triangle},
            {"pointMm", vector(walls->pointMm)},
            {"thinAreaMm2", number(walls->thinAreaMm2)}};
}

Json sizeJson(const SizeReport& size) {
    return {{"extentMm", vector(size.extentMm)},
            {"verdict", sizeWord(size.verdict)},
            {"guessedUnit", size.guess ? Json(toString(*size.guess)) : Json(nullptr)}};
}

Json gapJson(const NestingReport& report, const AffineTransform& toFrame) {
    if (report.gap.triangleA < 0) return nullptr;
    return {{"mm", number(report.gap.nearest.distanceMm)},
            {"innerTriangle", report.gap.triangleA},
            {"outerTriangle", report.gap.triangleB},
            {"innerPointMm", vector(toFrame(report.gap.nearest.pointA))},
            {"outerPointMm", vector(toFrame(report.gap.nearest.pointB))}};
}

}  // namespace

Json verdictJson(const std::vector<Check>& checks) {
    return {{"passed", allHold(checks)},
            {"failed", failedJson(checks)},
            {"checks", checksJson(checks)}};
}

Json factsJson(const SurfaceFacts& facts) {
    const TopologyReport& topology = facts.topology;
    return {
        {"vertices", topology.vertices},
        {"edges", topology.edges},
        {"triangles", topology.triangles},
        {"genus", orNull(topology.genus())},
        {"areaMm2", number(facts.areaMm2)},
        {"volumeMm3", facts.volumeMm3 ? number(*facts.volumeMm3) : Json(nullptr)},
        {"size", sizeJson(facts.size)},
        {"walls", wallsJson(facts.walls)},
        {"solidAngleShare", number(facts.solidAngle.share)},
        {"defects", defectsJson(facts)},
        {"examples", examplesJson(facts)},
        {"solids", facts.solids},
        {"sharedWallTriangles", facts.sharedWallTriangles},
        {"componentCount", topology.components.size()},
        {"components", componentsJson(facts)},
        {"componentsInsideOut", orNull(facts.insideOut)},
        {"selfIntersections", pairsJson(facts.intersections.pairCount,
                                        facts.intersections.isComplete, facts.intersections.pairs)},
        {"shape",
         {{"triangles", facts.shape.triangles},
          {"minAngleDeg", spreadJson(facts.shape.angleDeg)},
          {"aspectRatio", spreadJson(facts.shape.aspectRatio)},
          {"edgeMm", spreadJson(facts.shape.edgeMm)}}}};
}

Json nestingJson(const NestingReport& report, const std::vector<Check>& checks,
                 const AffineTransform& toFrame) {
    Json json = verdictJson(checks);
    json["relation"] = toString(report.relation);
    json["crossings"] = pairsJson(report.crossingPairs, report.isComplete, report.pairs);
    json["innerVertices"] = report.innerVertices;
    json["innerVerticesNotInside"] = report.innerVerticesNotInside;
    json["firstNotInside"] =
        report.firstNotInside < 0 ? Json(nullptr) : Json(report.firstNotInside);
    json["farthestOutMm"] = number(report.farthestOutMm);
    json["outerVertices"] = report.outerVertices;
    json["outerVerticesInside"] = report.outerVerticesInside;
    json["gap"] = gapJson(report, toFrame);
    return json;
}

std::span<const LengthFigure> lengthFigures() {
    static constexpr LengthFigure kRows[] = {
        {"mean", "mean", &DistanceStatistics::meanMm},
        {"rms", "RMS", &DistanceStatistics::rmsMm},
        {"p95", "95 % within", &DistanceStatistics::p95Mm},
        {"p99", "99 % within", &DistanceStatistics::p99Mm},
        {"max", "largest sampled", &DistanceStatistics::maxMm}};
    return kRows;
}

Json lengthsJson(const DistanceStatistics& distances, double unitMm, const std::string& unit) {
    Json json = Json::object();
    for (const LengthFigure& row : lengthFigures()) {
        json[std::string(row.key) + unit] = number(distances.*row.lengthMm / unitMm);
    }
    return json;
}

Json deviationJson(const DistanceStatistics& distances, const AffineTransform& toFrame) {
    Json json{{"samples", distances.samples}, {"measured", distances.measured()}};
    json.update(lengthsJson(distances, 1, "Mm"));
    json["meanErrorMm"] = number(distances.meanErrorMm);
    json["maxPointMm"] = vector(toFrame(distances.maxPointMm));
    return json;
}

Json distanceJson(const DistanceStatistics& distances, const AffineTransform& toFrame) {
    Json json = deviationJson(distances, toFrame);
    json["meanNormalDeviationDeg"] = number(distances.meanNormalDeviationDeg);
    json["p95NormalDeviationDeg"] = number(distances.p95NormalDeviationDeg);
    return json;
}

Json hausdorffJson(const HausdorffInterval& hausdorff, const AffineTransform& toFrame) {
    return {{"lowerMm", number(hausdorff.lowerMm)},
            {"upperMm", number(hausdorff.upperMm)},
            {"toleranceMm", number(hausdorff.toleranceMm)},
            {"isComplete", hausdorff.isComplete},
            {"pointMm", vector(toFrame(hausdorff.pointMm))},
            {"nearestMm", vector(toFrame(hausdorff.nearestMm))}};
}

std::vector<Warning> roughDistanceWarnings(const DistanceStatistics& distances,
                                           const HausdorffInterval& hausdorff) {
    std::vector<Warning> warnings;
    const auto warn = [&](std::int64_t points, const std::string& why) {
        if (points == 0) return;
        warnings.push_back({"distance-rough", counted(points, "point lies", "points lie") + why});
    };
    warn(distances.rough.rough,
         " about as far from more than 100 triangles each: distances there may be a hundredth too "
         "large");
    warn(distances.leftOut + distances.leftOutVertices,
         " near more than 500 triangles each, more than are measured: " +
             formatCount(distances.measured()) + " of " + formatCount(distances.samples) +
             " samples are, which gives the mean to within " + formatShort(distances.meanErrorMm) +
             " mm (two standard errors)");
    if (!hausdorff.isComplete) {
        warnings.push_back(
            {"distance-rough", "the maximum distance is known to lie between " +
                                   formatShort(hausdorff.lowerMm) + " and " +
                                   formatShort(hausdorff.upperMm) +
                                   " mm only: many triangles lie about as far from each point"});
    }
    return warnings;
}

}  // namespace adaptiso
