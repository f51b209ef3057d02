#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "Common/Json.h"
#include "Run.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/MeshQuality/Nesting.h"
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

/// Listed places, around which a promise does not hold.
struct Listed {
    const std::vector<MendedPlace>& places;
    double aroundMm;  ///< how far beyond them
};

/// The triangles that lie in no cube around a listed place.
TriangleMesh apartFrom(const TriangleMesh& mesh, std::initializer_list<Listed> lists) {
    std::vector<BoundingBox> cubes;
    for (const Listed& listed : lists) {
        for (const MendedPlace& place : listed.places) {
            cubes.push_back({place.middleMm, place.middleMm});
            cubes.back().widen(place.spanMm / 2 + listed.aroundMm);
        }
    }
    if (cubes.empty()) return mesh;
    const AabbTree tree(mesh);
    std::vector<std::uint8_t> isListed(mesh.triangles.size());
    for (const BoundingBox& cube : cubes) {
        tree.forEachOverlap(cube, [&](std::int64_t t) { isListed[t] = 1; });
    }
    TriangleMesh apart{mesh.points, {}, {}};
    for (std::size_t t = 0; t < isListed.size(); ++t) {
        if (isListed[t] == 0) apart.triangles.push_back(mesh.triangles[t]);
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
        requireWithin(found.maxMm, boundMm + verified.shiftMm, surface, input, name, kBroken);
        measured.samples += found.measured();
        measured.maxMm = std::max(measured.maxMm, found.maxMm);
    };
    const double shiftMm = verified.shiftMm;
    const double otherCapMm = shiftMm + statistics.maxErrorMm;  // one of two is listed
    check(apartFrom(surface, {{statistics.filled, shiftMm},
                              {statistics.cutHandles, otherCapMm},
                              {statistics.filledHandles, otherCapMm}}),
          input, statistics.resultToInputMm, "the input");
    check(apartFrom(input, {{statistics.inner, shiftMm},
                            {statistics.thin, shiftMm},
                            {statistics.droppedPieces, otherCapMm}}),
          surface, statistics.inputToResultMm, "the result");
    return measured;
}

InvalidInput tooFewDigits(const std::string& fault, const MendRun& run) {
    const MeshFormat& format = *run.output.format;
    return InvalidInput(baseName(run.output.file) + ": " + std::string(format.name) +
                        (format.sharesVertices
                             ? " keeps too few digits of this surface's coordinates, with which "
                             : " joins points whose digits are alike, with which ") +
                        fault + "; write .vtp or .ply");
}

}  // namespace

void verify(const VerifiedSurface& surface, const TriangleMesh& result, MendRun& run) {
    const bool mayBeOpen = !run.statistics.leftOpen.empty();
    run.output.topology = checkTopology(surface.surface);
    const std::string fault = soundnessFault(surface.surface, run.output.topology, mayBeOpen);
    if (!fault.empty()) {
        const std::string own = soundnessFault(result, checkTopology(result), mayBeOpen);
        if (!own.empty()) throw InternalError(kBroken + own);
        throw tooFewDigits(fault, run);
    }
    run.verification = measure(surface, run.statistics);
}

void verifyAround(const TriangleMesh& surface, const TriangleMesh& fixed, MendRun& run) {
    const NestingReport report = checkNesting(fixed, surface, {.maxPairs = 0});
    run.gapMm = report.gap.nearest.distanceMm;
    if (report.isStrictlyNested() && run.gapMm >= *run.command.gapMm) return;
    throw tooFewDigits(
        "it lies " + formatBound(run.gapMm) + " mm around " + baseName(run.command.around), run);
}

}  // namespace adaptiso::mender
