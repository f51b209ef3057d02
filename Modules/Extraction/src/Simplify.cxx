#include "adaptiso/Extraction/Simplify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/detail/UnitScale.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/Parameters.h"
#include "adaptive/full/MeshSurface.h"
#include "repair/MeshParts.h"

namespace adaptiso {
namespace {

SurfacePoint surfacePointAt(const Vec3& p, const TriangleMesh& mesh, std::int64_t triangle) {
    const Triangle& t = mesh.triangles[triangle];
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const Vec3 area2 = areaVector2(a, b, c);
    const double whole = squaredNorm(area2);
    if (!(whole > 0)) return {triangle, {1, 0, 0}};
    const double u = std::max(0.0, dot(areaVector2(p, b, c), area2) / whole),
                 v = std::max(0.0, dot(areaVector2(a, p, c), area2) / whole),
                 w = std::max(0.0, dot(areaVector2(a, b, p), area2) / whole);
    const double sum = u + v + w;
    return {triangle, {u / sum, v / sum, w / sum}};
}

}  // namespace

std::vector<SurfacePoint> nearestPoints(const TriangleMesh& mesh, const TriangleMesh& onto) {
    if (onto.triangles.empty()) throw InvalidInput("nearestPoints: the surface has no triangle");
    const AabbTree tree(onto);
    std::vector<SurfacePoint> places(mesh.points.size());
    findNearestPlaces(
        onto, tree, std::ssize(places), [&](std::int64_t v) { return mesh.points[v]; },
        [&](std::int64_t v, const ClosestPoint& nearest) {
            if (nearest.triangle < 0) {
                throw InvalidInput("nearestPoints: a coordinate is not finite");
            }
            places[v] = surfacePointAt(nearest.pointMm, onto, nearest.triangle);
        },
        false);
    return places;
}

std::vector<Normal> detail::normalsFrom(const TriangleMesh& input, const TriangleMesh& mesh) {
    std::vector<Normal> normals;
    normals.reserve(mesh.points.size());
    for (const SurfacePoint& place : nearestPoints(mesh, input)) {
        Vec3 sum;
        for (int c = 0; c < 3; ++c) {
            const VertexId v = input.triangles[place.triangle][c];
            sum += place.weight[c] * toVec3(input.normals[v]);
        }
        normals.push_back(toNormal(sum));
    }
    return normals;
}

namespace {

/// A distance in double precision is known to 1e-15 of the coordinates or so.
void requireProvable(const TriangleMesh& mesh, const SimplifyOptions& options) {
    constexpr double kLeastPart = 1e-12;
    if (!options.maxErrorMm || mesh.points.empty()) return;
    const BoundingBox box = boundingBox(mesh);
    if (*options.maxErrorMm < kLeastPart * norm(box.size())) {
        throw InvalidInput(
            "simplify: maxErrorMm is less than 1e-12 of the mesh's diagonal; rounding of "
            "coordinates is as large");
    }
}

Simplified simplifyNearOne(const TriangleMesh& mesh, const SimplifyOptions& options) {
    requireProvable(mesh, options);
    const double mayMoveMm =
        detail::kNeedlePart * options.maxErrorMm.value_or(std::numeric_limits<double>::max());
    detail::MeshParts parts = detail::takeApart(mesh, options.keepBorders, mayMoveMm);
    AdaptiveOptions aims{options, {}};
    if (aims.maxErrorMm) *aims.maxErrorMm -= parts.movedMm;
    detail::AdaptiveResult made = detail::simplifyWithin(
        detail::MeshSurface(mesh, parts, aims.maxErrorMm), aims, options.progress);
    Simplified result;
    result.mesh = std::move(made.mesh);
    if (!mesh.normals.empty()) {
        result.mesh.normals = detail::normalsFrom(mesh, result.mesh);
    }
    SimplifyStatistics& statistics = result.statistics;
    statistics.degenerateTriangles = parts.degenerate;
    statistics.duplicateTriangles = parts.duplicate;
    statistics.borderEdges = std::ssize(parts.borderEdges);
    statistics.nonManifoldVertices = std::move(parts.nonManifold);
    const auto asInInput = [&](std::vector<std::int64_t> triangles) {
        for (std::int64_t& t : triangles) {
            if (!parts.inputTriangle.empty()) t = parts.inputTriangle[t];
        }
        std::ranges::sort(triangles);
        return triangles;
    };
    statistics.crossingTriangles = asInInput(std::move(parts.crossing.found));
    statistics.undecidedTriangles = asInInput(std::move(parts.crossing.undecided));
    std::ranges::sort(statistics.nonManifoldVertices);
    statistics.errorBoundMm = made.errorBoundMm + parts.movedMm;
    statistics.wantedTriangles = made.wantedTriangles;
    statistics.work = made.work;
    return result;
}

}  // namespace

const Options<SimplifyOptions>& simplifyOptions() {
    static const Options<SimplifyOptions> kRows{
        option<&SimplifyOptions::keepBorders>(
            {.name = "keep-borders",
             .key = "keepBorders",
             .label = "Open borders kept",
             .help = "Leave the points of open borders where they are, to the bit"}),
        option<&SimplifyOptions::weld>(
            {.name = "weld",
             .key = "weld",
             .label = "Points at one place joined",
             .help = "Join points with equal coordinates first: programs that store a normal or a "
                     "colour for each corner (Blender, glTF) part the surface there"})};
    return kRows;
}

Simplified simplify(const TriangleMesh& mesh, const SimplifyOptions& options) {
    const AdaptiveOptions aims{options, {}};
    requireInRange(aims, "simplify");
    if (!aims.maxErrorMm && !aims.maxTriangles && !aims.reduction) {
        throw InvalidInput("simplify: neither maxErrorMm nor maxTriangles nor reduction is set");
    }
    if (options.weld) {
        TriangleMesh joined = mesh;
        joinVertices(joined);
        SimplifyOptions others = options;
        others.weld = false;
        return simplify(joined, others);
    }
    const int exponent = detail::exponentTowardsOne(mesh);
    if (exponent == 0) return simplifyNearOne(mesh, options);
    TriangleMesh scaled = mesh;
    detail::scale(scaled, exponent);
    SimplifyOptions scaledOptions = options;
    if (options.maxErrorMm) {
        constexpr double kLeast = std::numeric_limits<double>::min(), kBeyondAll = 1e6;
        scaledOptions.maxErrorMm =
            std::clamp(std::ldexp(*options.maxErrorMm, exponent), kLeast, kBeyondAll);
    }
    Simplified result = simplifyNearOne(scaled, scaledOptions);
    detail::scale(result.mesh, -exponent);
    result.statistics.errorBoundMm = std::ldexp(result.statistics.errorBoundMm, -exponent);
    return result;
}

}  // namespace adaptiso
