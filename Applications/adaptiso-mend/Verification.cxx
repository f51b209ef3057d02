#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "Common/Json.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Tiles.h"
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

/// The triangles that lie in no cube around a listed place, in which a promise does not hold.
TriangleMesh apartFrom(const TriangleMesh& mesh, double roundingMm,
                       std::initializer_list<const std::vector<MendedPlace>*> lists) {
    std::vector<BoundingBox> cubes;
    for (const auto* const places : lists) {
        for (const MendedPlace& place : *places) {
            cubes.push_back({place.middleMm, place.middleMm});
            cubes.back().widen(place.spanMm / 2 + roundingMm);
        }
    }
    if (cubes.empty()) return mesh;
    TriangleMesh apart{mesh.points, {}, {}};
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        const BoundingBox box = boxOf(cornersOf(mesh, t));
        const bool isListed = std::any_of(cubes.begin(), cubes.end(), [&](const BoundingBox& cube) {
            return cube.overlaps(box);
        });
        if (!isListed) apart.triangles.push_back(mesh.triangles[t]);
    }
    return withoutUnusedPoints(std::move(apart));
}

/// Measures distances where they are promised.
Verification measure(const VerifiedSurface& verified, const MendStatistics& statistics) {
    const TriangleMesh& surface = verified.surface;
    const TriangleMesh input = withArea(verified.input);
    Verification measured;
    const auto check = [&](const TriangleMesh& from, const TriangleMesh& to, double boundMm,
                           const char* name) {
        if (from.triangles.empty()) return;
        const DistanceStatistics found = sampledDistance(from, to, false).aToB;
        requireWithin(found.maxMm, boundMm + verified.roundingMm, surface, input, name, kBroken);
        measured.samples += found.measured();
        measured.maxMm = std::max(measured.maxMm, found.maxMm);
    };
    check(apartFrom(surface, verified.roundingMm,
                    {&statistics.filled, &statistics.cutHandles, &statistics.filledHandles}),
          input, statistics.resultToInputMm, "the input");
    check(apartFrom(input, verified.roundingMm, {&statistics.inner, &statistics.thin}), surface,
          statistics.inputToResultMm, "the result");
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
