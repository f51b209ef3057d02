#include <algorithm>
#include <array>
#include <limits>

#include "Common/ReportOutput.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::simplifier {
namespace {

struct Kind {
    TopologyDefect defect;
    std::string_view key;
    const char* one;
    const char* many;
    bool isDropped, isFault;
};

constexpr std::array<Kind, 7> kKinds{{
    {TopologyDefect::BoundaryEdge, "borderEdges", "open border edge", "open border edges", false,
     true},
    {TopologyDefect::NonManifoldEdge, "nonManifoldEdges", "edge with three triangles or more",
     "edges with three triangles or more", false, true},
    {TopologyDefect::InconsistentEdge, "inconsistentEdges",
     "edge whose triangles face opposite sides", "edges whose triangles face opposite sides", false,
     true},
    {TopologyDefect::NonManifoldVertex, "nonManifoldVertices",
     "vertex whose triangles are not one fan", "vertices whose triangles are not one fan", false,
     true},
    {TopologyDefect::DegenerateTriangle, "degenerateTriangles", "triangle without area",
     "triangles without area", true, true},
    {TopologyDefect::DuplicateTriangle, "duplicateTriangles", "triangle that is there twice",
     "triangles that are there twice", true, true},
    {TopologyDefect::UnusedVertex, "unusedVertices", "vertex that no triangle uses",
     "vertices that no triangle uses", true, false},
}};

}  // namespace

std::string Finding::text() const {
    std::string text = formatCount(count) + " " + what + (isDropped ? ", dropped" : "");
    if (placeMm) {
        text += count == 1 ? ", at " : ", the first at ";
        text += formatShort(placeMm->x) + ", " + formatShort(placeMm->y) + ", " +
                formatShort(placeMm->z);
    }
    return text;
}

bool isSound(const std::vector<Finding>& findings) {
    return std::none_of(findings.begin(), findings.end(),
                        [](const Finding& finding) { return finding.isFault; });
}

std::vector<Finding> findTopologyFaults(const TopologyReport& topology) {
    std::vector<Finding> findings;
    for (const Kind& kind : kKinds) {
        const std::int64_t count = topology.count(kind.defect);
        if (count == 0) continue;
        Finding& finding = findings.emplace_back();
        finding.key = kind.key;
        finding.what = count == 1 ? kind.one : kind.many;
        finding.count = count;
        finding.isDropped = kind.isDropped;
        finding.isFault = kind.isFault;
        const auto example =
            std::find_if(topology.examples.begin(), topology.examples.end(),
                         [&](const TopologyExample& each) { return each.defect == kind.defect; });
        if (example != topology.examples.end()) finding.placeMm = example->pointMm;
    }
    return findings;
}

std::optional<Finding> crossingFinding(const TriangleMesh& mesh,
                                       const std::vector<std::int64_t>& triangles) {
    if (triangles.empty()) return std::nullopt;
    Finding finding;
    finding.key = "crossingTriangles";
    finding.count = std::ssize(triangles);
    finding.what =
        finding.count == 1 ? "triangle that crosses another" : "triangles that cross others";
    finding.placeMm = middleOf(mesh, triangles.front());
    return finding;
}

std::vector<std::int64_t> findCrossing(const TriangleMesh& mesh) {
    SelfIntersectionOptions options;
    options.maxPairs = std::numeric_limits<std::int64_t>::max();
    std::vector<std::int64_t> triangles;
    for (const TrianglePair& pair : findSelfIntersections(mesh, options).pairs) {
        triangles.insert(triangles.end(), pair.begin(), pair.end());
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    return triangles;
}

}  // namespace adaptiso::simplifier
