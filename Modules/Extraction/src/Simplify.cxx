#include "adaptiso/Extraction/Simplify.h"

#include <algorithm>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/full/MeshParts.h"
#include "adaptive/full/MeshSurface.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kPiece = 1 << 10;

AdaptiveOptions aimsOf(const SimplifyOptions& options) {
    AdaptiveOptions aims;
    aims.maxErrorMm = options.maxErrorMm;
    aims.maxTriangles = options.maxTriangles;
    aims.reduction = options.reduction;
    aims.minAngleDeg = options.minAngleDeg;
    return aims;
}

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

std::vector<Normal> normalsFrom(const TriangleMesh& input, const TriangleMesh& mesh) {
    std::vector<Normal> normals(mesh.points.size());
    const std::vector<SurfacePoint> places = nearestPoints(mesh, input);
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const Triangle& t = input.triangles[places[v].triangle];
        Vec3 sum;
        for (int c = 0; c < 3; ++c) {
            const Normal& n = input.normals[t[c]];
            sum += places[v].weight[c] * Vec3{n.x, n.y, n.z};
        }
        normals[v] = toNormal(sum);
    }
    return normals;
}

}  // namespace

std::vector<SurfacePoint> nearestPoints(const TriangleMesh& mesh, const TriangleMesh& onto) {
    if (onto.triangles.empty()) throw InvalidInput("nearestPoints: the surface has no triangle");
    const AabbTree tree(onto);
    std::vector<SurfacePoint> places(mesh.points.size());
    parallelForPieces(std::ssize(places), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            const ClosestPoint nearest = tree.closestPoint(mesh.points[v]);
            if (nearest.triangle < 0) {
                throw InvalidInput("nearestPoints: a coordinate is not finite");
            }
            places[v] = surfacePointAt(nearest.pointMm, onto, nearest.triangle);
        }
    });
    return places;
}

Simplified simplify(const TriangleMesh& mesh, const SimplifyOptions& options) {
    const AdaptiveOptions aims = aimsOf(options);
    detail::requireInRange(aims, "simplify");
    if (!aims.maxErrorMm && !aims.maxTriangles && !aims.reduction) {
        throw InvalidInput("simplify: neither maxErrorMm nor maxTriangles nor reduction is set");
    }
    detail::MeshParts parts = detail::takeApart(mesh, options.keepBorders);
    detail::AdaptiveResult made = detail::simplifyWithin(
        detail::MeshSurface(mesh, parts, options.maxErrorMm), aims, options.progress);
    Simplified result;
    result.mesh = std::move(made.mesh);
    if (!mesh.normals.empty()) result.mesh.normals = normalsFrom(mesh, result.mesh);
    SimplifyStatistics& statistics = result.statistics;
    statistics.degenerateTriangles = parts.degenerate;
    statistics.duplicateTriangles = parts.duplicate;
    statistics.borderEdges = std::ssize(parts.borderEdges);
    statistics.nonManifoldVertices = std::move(parts.nonManifold);
    for (const std::int64_t t : parts.crossing) {
        statistics.crossingTriangles.push_back(
            parts.inputTriangle.empty() ? t : std::int64_t{parts.inputTriangle[t]});
    }
    statistics.errorBoundMm = made.errorBoundMm;
    statistics.wantedTriangles = made.wantedTriangles;
    return result;
}

}  // namespace adaptiso
