#include "adaptiso/HeadModel/NestSurfaces.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "PushApart.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

void checkInput(const std::vector<TriangleMesh>& surfaces, const NestOptions& options) {
    if (options.fixedSurface >= surfaces.size()) {
        throw InvalidInput("nestSurfaces: fixedSurface is " + std::to_string(options.fixedSurface) +
                           " of " + std::to_string(surfaces.size()) + " surfaces");
    }
    const std::size_t gaps = options.minGapsMm.size();
    if (gaps != 1 && gaps + 1 != surfaces.size()) {
        throw InvalidInput("nestSurfaces: " + std::to_string(gaps) + " gaps for " +
                           std::to_string(surfaces.size()) +
                           " surfaces, must be one or one for each pair");
    }
    for (const double gap : options.minGapsMm) {
        if (gap > 0 && std::isfinite(gap)) continue;
        throw InvalidInput("nestSurfaces: a least gap of " + std::to_string(gap) +
                           " mm, must be above 0");
    }
    if (!(options.maxMoveMm > 0)) {
        throw InvalidInput("nestSurfaces: maxMoveMm is " + std::to_string(options.maxMoveMm) +
                           ", must be above 0");
    }
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        if (isOneSolid(surfaces[n])) continue;
        throw InvalidInput("nestSurfaces: surface " + std::to_string(n) +
                           " is not one closed outward manifold without degenerate triangles");
    }
}

/// Least gap between surfaces n and n + 1.
double gapOf(const NestOptions& options, std::size_t n) {
    return options.minGapsMm[options.minGapsMm.size() == 1 ? 0 : n];
}

/// Faults that no movement can mend: surfaces that cross themselves, or in a wrong order.
/// \param nesting  gets the report of each pair
std::vector<Finding> findHopeless(const std::vector<TriangleMesh>& surfaces,
                                  std::vector<NestingReport>& nesting) {
    std::vector<Finding> findings;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const TriangleMesh& surface = surfaces[n];
        const SelfIntersections crossings = findSelfIntersections(surface);
        if (!crossings.isClear()) {
            const std::int64_t first = crossings.pairs.empty() ? 0 : crossings.pairs[0][0];
            findings.push_back({"surface " + std::to_string(n) + ": " + crossingText(crossings),
                                surface.points[surface.triangles[first][0]]});
        }
        if (n + 1 == surfaces.size()) break;
        const NestingReport& report = nesting.emplace_back(checkNesting(surface, surfaces[n + 1]));
        if (report.relation == NestingRelation::Swapped ||
            report.relation == NestingRelation::Apart) {
            findings.push_back({"surfaces " + std::to_string(n) + " and " + std::to_string(n + 1) +
                                    ": they are " + std::string(toString(report.relation)) +
                                    ", not nested",
                                report.gap.nearest.pointA});
        }
    }
    return findings;
}

SurfaceMove measureMove(const TriangleMesh& before, const TriangleMesh& after) {
    SurfaceMove move;
    for (std::size_t v = 0; v < before.points.size(); ++v) {
        const double mm = norm(after.points[v] - before.points[v]);
        if (mm == 0) continue;
        ++move.movedVertices;
        move.meanMm += mm;
        if (mm > move.maximumMm) {
            move.maximumMm = mm;
            move.maximumPointMm = before.points[v];
        }
    }
    if (move.movedVertices > 0) move.meanMm /= static_cast<double>(move.movedVertices);
    return move;
}

/// Checks the promised gaps and nesting by code other than that which made them.
/// \param nesting  the report of each pair as it is now
void verify(const NestOptions& options, const std::vector<NestingReport>& nesting,
            NestResult& result) {
    for (std::size_t n = 0; n + 1 < result.surfaces.size(); ++n) {
        const double wanted = gapOf(options, n);
        const NestingReport& report = nesting[n];
        const auto& [mm, inner, outer] = report.gap.nearest;
        result.gaps.push_back({mm, inner, outer});
        if (!report.isStrictlyNested() || !(mm >= wanted)) {
            result.findings.push_back(
                {"surfaces " + std::to_string(n) + " and " + std::to_string(n + 1) + " are " +
                     std::string(toString(report.relation)) + ", " + std::to_string(mm) +
                     " mm apart; wanted nested, " + std::to_string(wanted) + " mm",
                 inner});
        }
    }
}

}  // namespace

NestResult nestSurfaces(const std::vector<TriangleMesh>& surfaces, const NestOptions& options) {
    checkInput(surfaces, options);
    NestResult result;
    std::vector<NestingReport> nesting;
    result.findings = findHopeless(surfaces, nesting);
    result.surfaces = surfaces;
    bool hasFixedMoved = false;
    const auto push = [&](std::size_t moving, std::size_t fixed) {
        if (!result.findings.empty()) return;
        const std::size_t inner = std::min(moving, fixed);
        const double gap = gapOf(options, inner);
        NestingReport& report = nesting[inner];
        const auto check = [&] {
            report = checkNesting(result.surfaces[inner], result.surfaces[inner + 1]);
        };
        if (hasFixedMoved && fixed != options.fixedSurface) check();
        hasFixedMoved = false;  // the one that moves is the next one's fixed one
        if (report.isStrictlyNested() && report.gap.nearest.distanceMm >= gap) return;
        hasFixedMoved = true;
        auto finding = pushApart(result.surfaces[moving], result.surfaces[fixed],
                                 {gap, options.maxMoveMm, moving > fixed});
        if (!finding) return check();
        finding->what = "surface " + std::to_string(moving) + ": " + finding->what;
        result.findings.push_back(*finding);
    };
    for (std::size_t n = options.fixedSurface + 1; n < surfaces.size(); ++n) push(n, n - 1);
    for (std::size_t n = options.fixedSurface; n > 0; --n) push(n - 1, n);
    if (result.findings.empty()) verify(options, nesting, result);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        result.moves.push_back(measureMove(surfaces[n], result.surfaces[n]));
        if (result.moves.back().movedVertices > 0) result.surfaces[n].normals.clear();
    }
    if (!result.findings.empty()) {
        result.surfaces.clear();
        result.gaps.clear();
    }
    return result;
}

bool isOneSolid(const TriangleMesh& mesh) {
    const TopologyReport report = checkTopology(mesh);
    return report.isSound() && report.components.size() == 1 && report.components[0].isOutward();
}

NestedAround nestAround(const TriangleMesh& mesh, const TriangleMesh& fixed, double gapMm) {
    if (!isOneSolid(mesh)) throw InvalidInput("the surface to move is not closed, or in pieces");
    if (!isOneSolid(fixed)) {
        throw InvalidInput("the fixed surface is no closed, oriented 2-manifold in one piece");
    }
    NestOptions options;
    options.minGapsMm = {gapMm};
    options.maxMoveMm = norm(boundingBox(mesh).size());  // the number of moves is bounded
    NestResult result = nestSurfaces({fixed, mesh}, options);
    if (!result.findings.empty()) {
        const auto& [what, at] = result.findings.front();
        const std::size_t which = what.find(": ");  // surface 1; one of them, as numbers differ
        throw InvalidInput((which == std::string::npos ? what : what.substr(which + 2)) +
                           ", around " + formatShort(at.x) + ", " + formatShort(at.y) + ", " +
                           formatShort(at.z));
    }
    return {std::move(result.surfaces[1].points), result.moves[1], result.gaps[0]};
}

}  // namespace adaptiso
