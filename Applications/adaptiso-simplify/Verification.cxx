#include <array>
#include <map>
#include <optional>
#include <string>

#include "Common/Json.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"

namespace adaptiso::simplifier {
namespace {

constexpr const char* kBroken = "the surface breaks its promise: ";

SelfIntersections crossingPairs(const TriangleMesh& mesh) {
    return findSelfIntersections(mesh, {.maxPairs = 0});
}

/// Nothing but open borders is wrong with it: pieces and handles mean something.
bool isManifoldSurface(const TopologyReport& topology) {
    return topology.isManifold() && topology.isOriented() &&
           topology.count(TopologyDefect::DegenerateTriangle) == 0 &&
           topology.count(TopologyDefect::DuplicateTriangle) == 0;
}

/// Triangles on the corners of others, by places: without the triangles between two points of one
/// place those beside them have the same corners.
std::int64_t duplicatesByPlace(TriangleMesh mesh) {
    std::map<std::array<double, 3>, VertexId> first;
    for (Triangle& triangle : mesh.triangles) {
        for (VertexId& v : triangle) {
            const Vec3& p = mesh.points[v];
            v = first.emplace(std::array{p.x, p.y, p.z}, v).first->second;
        }
    }
    return checkTopology(mesh).count(TopologyDefect::DuplicateTriangle);
}

/// The fault of `topology`, the result's; empty if there is none.
std::string topologyFault(const TriangleMesh& input, const TopologyReport& before,
                          const TopologyReport& topology) {
    const auto hasMore = [&](TopologyDefect defect) {
        return topology.count(defect) > before.count(defect);
    };
    if (hasMore(TopologyDefect::DegenerateTriangle)) return "a triangle has no area";
    if (hasMore(TopologyDefect::DuplicateTriangle) &&
        topology.count(TopologyDefect::DuplicateTriangle) > duplicatesByPlace(input)) {
        return "a triangle is there twice";
    }
    if (!isManifoldSurface(before)) return {};
    if (!isManifoldSurface(topology)) return "it is no oriented 2-manifold";
    if (before.isClosed() != topology.isClosed()) return "it is not closed as the input is";
    return hasSameShape(before, topology) ? "" : "its pieces or holes are not the input's";
}

std::int64_t insideOutPieces(const TriangleMesh& mesh, const TopologyReport& topology) {
    const bool isTold =
        topology.isWatertight() && topology.count(TopologyDefect::NonFiniteVertex) == 0;
    const auto pieces = isTold ? findInsideOutPieces(mesh, topology) : std::nullopt;
    return pieces ? std::ssize(*pieces) : 0;
}

/// The fault of a surface made from the run's input; empty if it is sound.
std::string soundnessFault(const VerifiedSurface& surface, const TriangleMesh& mesh,
                           const TopologyReport& topology, const SimplifyRun& run) {
    std::string fault = topologyFault(surface.input, run.input.topology, topology);
    if (!fault.empty()) return fault;
    const SelfIntersections pairs = crossingPairs(mesh);
    const SelfIntersections before = pairs.isClear() ? pairs : crossingPairs(surface.input);
    // of an input with more crossings than are counted there is nothing to compare with
    if (before.isComplete && (!pairs.isComplete || pairs.pairCount > before.pairCount)) {
        return crossingText(pairs) + ", " + formatCount(before.pairCount) + " of the input";
    }
    const std::int64_t pieces = insideOutPieces(mesh, topology);
    const std::int64_t inInput =
        pieces == 0 ? 0 : insideOutPieces(surface.input, run.input.topology);
    if (pieces <= inInput) return {};
    return formatCount(pieces) + " pieces are inside out, " + formatCount(inInput) +
           " of the input";
}

}  // namespace

void verify(const VerifiedSurface& surface, SimplifyRun& run) {
    run.output.topology = checkTopology(surface.written);
    const std::string fault = soundnessFault(surface, surface.written, run.output.topology, run);
    if (!fault.empty()) {
        const std::string own =
            soundnessFault(surface, surface.result, checkTopology(surface.result), run);
        if (!own.empty()) throw InternalError(kBroken + own);
        throw InvalidInput(baseName(run.output.file) + ": " + std::string(run.output.format->name) +
                           " keeps too few digits of this surface's coordinates, with which " +
                           fault + "; write .vtp or .ply");
    }
    const TriangleMesh& input = surface.input;
    run.verification = verifyDistance(
        surface.written, run.statistics.degenerateTriangles == 0 ? input : withArea(input),
        run.statistics.errorBoundMm + surface.roundingMm, "the input", kBroken);
}

}  // namespace adaptiso::simplifier
