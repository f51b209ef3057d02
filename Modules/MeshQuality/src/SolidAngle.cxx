#include "adaptiso/MeshQuality/SolidAngle.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "ExactTriangle.h"
#include "RequireIndices.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

/// Signed solid angle of a triangle seen from the origin: positive seen from behind.
double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double triple = dot(a, cross(b, c));
    return 2 * std::atan2(triple, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

double solidAngleShare(const TriangleMesh& mesh, const Vec3& p) {
    requireIndices(mesh, "solidAngleShare");
    constexpr std::int64_t kGrain = 4096;
    const std::int64_t count = std::ssize(mesh.triangles);
    std::vector<double> sums((count + kGrain - 1) / kGrain);
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        double sum = 0;
        for (std::int64_t n = begin; n < end; ++n) {
            const Corners t = cornersOf(mesh, n);
            sum += solidAngle(t[0] - p, t[1] - p, t[2] - p);
        }
        sums[begin / kGrain] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) / (4 * std::numbers::pi);
}

SolidAngleCriterion solidAngleFromMean(const TriangleMesh& mesh) {
    if (mesh.points.empty()) return {std::numeric_limits<double>::quiet_NaN()};
    Vec3 sum;
    for (const Vec3& p : mesh.points) sum += p;
    return {solidAngleShare(mesh, 1.0 / static_cast<double>(mesh.points.size()) * sum)};
}

}  // namespace adaptiso
