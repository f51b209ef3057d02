#include <algorithm>
#include <string>

#include "Common/Json.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"

namespace adaptiso::mender {
namespace {

constexpr const char* kBroken = "the surface breaks its promise: ";

/// The fault of a mended surface; empty if it is sound.
std::string soundnessFault(const TriangleMesh& mesh, const TopologyReport& topology,
                           bool mayBeOpen) {
    if (topology.count(TopologyDefect::DegenerateTriangle) > 0) return "a triangle has no area";
    if (topology.count(TopologyDefect::DuplicateTriangle) > 0) return "a triangle is there twice";
    if (!topology.isManifold() || !topology.isOriented()) return "it is no oriented 2-manifold";
    if (!mayBeOpen && !topology.isClosed()) return "it is not closed";
    const SelfIntersections crossings = findSelfIntersections(mesh, {.maxPairs = 0});
    if (!crossings.isClear()) return crossingText(crossings);
    if (!topology.isClosed()) return {};
    const auto pieces = findInsideOutPieces(mesh, topology);
    return pieces && !pieces->empty() ? formatCount(std::ssize(*pieces)) + " pieces are inside out"
                                      : std::string();
}

/// The input without the triangles that have no area, of which nothing is promised.
TriangleMesh withArea(const TriangleMesh& input) {
    TriangleMesh mesh = input;
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return isDegenerate(input, t); });
    return mesh;
}

/// Measures distances in the directions in which all of a surface is promised to lie near.
Verification measure(const VerifiedSurface& verified, const MendStatistics& statistics) {
    const TriangleMesh& surface = verified.surface;
    const TriangleMesh input = withArea(verified.input);
    const DistanceReport report = sampledDistance(surface, input);
    Verification measured;
    if (statistics.filled.empty()) {
        requireWithin(report.aToB.maxMm, statistics.resultToInputMm + verified.roundingMm, surface,
                      input, "the input", kBroken);
        measured.samples += report.aToB.measured();
        measured.maxMm = report.aToB.maxMm;
    }
    if (statistics.inner.empty() && statistics.thin.empty()) {
        requireWithin(report.bToA.maxMm, statistics.inputToResultMm + verified.roundingMm, surface,
                      input, "the result", kBroken);
        measured.samples += report.bToA.measured();
        measured.maxMm = std::max(measured.maxMm, report.bToA.maxMm);
    }
    return measured;
}

}  // namespace

void verify(const VerifiedSurface& surface, const TriangleMesh& result, MendRun& run) {
    const bool mayBeOpen = !run.statistics.leftOpen.empty();
    run.output.topology = checkTopology(surface.surface);
    const std::string fault = soundnessFault(surface.surface, run.output.topology, mayBeOpen);
    if (!fault.empty()) {
        const std::string own = soundnessFault(result, checkTopology(result), mayBeOpen);
        if (!own.empty()) throw InternalError(kBroken + own);
        throw InvalidInput(baseName(run.output.file) + ": " + std::string(run.output.format->name) +
                           " keeps too few digits of this surface's coordinates, with which " +
                           fault + "; write .vtp or .ply");
    }
    run.verification = measure(surface, run.statistics);
}

}  // namespace adaptiso::mender
