#include <algorithm>
#include <array>

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

/// Triangles with the corners of another, the same way round.
std::int64_t countSameWayRound(const TriangleMesh& mesh) {
    std::vector<Triangle> turned = mesh.triangles;
    for (Triangle& t : turned)
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(turned.begin(), turned.end());
    return std::ssize(turned) - (std::unique(turned.begin(), turned.end()) - turned.begin());
}

/// simplify() drops those the same way round, and keeps two of opposite ways.
void splitDuplicates(const TriangleMesh& mesh, std::vector<Finding>& findings) {
    const auto found = std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
        return finding.key == "duplicateTriangles";
    });
    if (found == findings.end()) return;
    const std::int64_t dropped = std::min(found->count, countSameWayRound(mesh));
    Finding opposite = *found;
    opposite.key = "oppositeTriangles";
    opposite.count = found->count - dropped;
    opposite.isDropped = false;
    opposite.what = opposite.count == 1
                        ? "triangle on the corners of another, facing the other way"
                        : "triangles on the corners of others, facing the other way";
    if (opposite.count == 0) return;
    if (dropped == 0) {
        *found = opposite;
        return;
    }
    found->count = dropped;
    if (dropped == 1) found->what = "triangle that is there twice";
    findings.insert(found, opposite);
}

}  // namespace

std::string Finding::text() const {
    if (count == 0) {
        return what +
               ": not decided: hundreds of triangles lie near each one, more than are tested";
    }
    std::string text = foundText(count, isComplete) + " " + what + (isDropped ? ", dropped" : "");
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

std::vector<Finding> findTopologyFaults(const TriangleMesh& mesh, const TopologyReport& topology) {
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
    splitDuplicates(mesh, findings);
    return findings;
}

void addJoined(std::int64_t joined, std::vector<Finding>& findings) {
    if (joined == 0) return;
    std::erase_if(findings, [&](Finding& finding) {
        if (finding.key != "unusedVertices") return false;
        finding.count -= joined;
        finding.placeMm.reset();
        return finding.count == 0;
    });
    Finding& finding = findings.emplace_back();
    finding.key = "joinedVertices";
    finding.what = joined == 1 ? "vertex at the place of another, joined with it"
                               : "vertices at the place of another, joined with it";
    finding.count = joined;
    finding.isFault = false;
}

std::optional<Finding> crossingFinding(const TriangleMesh& mesh,
                                       const CrossingTriangles& triangles) {
    if (triangles.isEmpty()) return std::nullopt;
    Finding finding;
    finding.key = "crossingTriangles";
    finding.count = std::ssize(triangles.found);
    finding.isComplete = triangles.isComplete();
    finding.what =
        finding.count == 1 ? "triangle that crosses another" : "triangles that cross others";
    if (!triangles.found.empty()) finding.placeMm = middleOf(mesh, triangles.found.front());
    return finding;
}

}  // namespace adaptiso::simplifier
