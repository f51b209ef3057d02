#include "adaptiso/MeshQuality/SurfaceDistance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kGrain = 4096;

/// \throws InvalidInput when the mesh is no surface to measure
void requireMeasurable(const TriangleMesh& mesh, std::string_view name) {
    const std::string where = "surface " + std::string(name);
    const auto pointCount = static_cast<VertexId>(mesh.points.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        for (const VertexId v : mesh.triangles[n]) {
            if (v < 0 || v >= pointCount) {
                throw InvalidInput(where + ": triangle " + std::to_string(n) + " names vertex " +
                                   std::to_string(v) + ", the mesh has " +
                                   std::to_string(pointCount) + " points");
            }
            if (!std::isfinite(squaredNorm(mesh.points[v]))) {
                throw InvalidInput(where + ": vertex " + std::to_string(v) +
                                   " has a coordinate that is not finite");
            }
        }
    }
    if (!(surfaceArea(mesh) > 0)) {
        throw InvalidInput(where + " has no area, so there is nothing to measure");
    }
}

struct SurfacePoint {
    Vec3 pointMm;
    std::int64_t triangle;
};

/// Points spread evenly over the area of a mesh; surfaceDistance says how.
class SurfaceSampler {
public:
    SurfaceSampler(const TriangleMesh& mesh, std::int64_t samples)
        : mesh_(mesh), samples_(samples) {
        areaUpTo_.reserve(mesh.triangles.size());
        double area = 0;
        for (const auto& [a, b, c] : mesh.triangles) {
            area += norm(areaVector2(mesh.points[a], mesh.points[b], mesh.points[c])) / 2;
            areaUpTo_.push_back(area);
        }
    }

    SurfacePoint at(std::int64_t sample) const {
        const double area =
            (static_cast<double>(sample) + 0.5) / static_cast<double>(samples_) * areaUpTo_.back();
        const auto found = std::upper_bound(areaUpTo_.begin(), areaUpTo_.end(), area);
        const std::int64_t triangle =
            std::min<std::int64_t>(found - areaUpTo_.begin(), areaUpTo_.size() - 1);
        const auto& [a, b, c] = mesh_.triangles[triangle];
        double u = fractionOfTurn(sample, kStepU), v = fractionOfTurn(sample, kStepV);
        if (u + v > 1) {  // the other half of the parallelogram, turned onto the triangle
            u = 1 - u;
            v = 1 - v;
        }
        const Vec3& origin = mesh_.points[a];
        return {origin + u * (mesh_.points[b] - origin) + v * (mesh_.points[c] - origin), triangle};
    }

private:
    // 1 / g and 1 / g^2 of the plastic number g = 1.3247..., in 1 / 2^64: whole numbers wrap round
    // without loss, however many the samples.
    static constexpr std::uint64_t kStepU = 0xc13fa9a902a6328f;
    static constexpr std::uint64_t kStepV = 0x91e10da5c79e7b1d;

    static double fractionOfTurn(std::int64_t sample, std::uint64_t step) {
        const std::uint64_t turn = (static_cast<std::uint64_t>(sample) + 1) * step;
        return static_cast<double>(turn >> 11) * 0x1p-53;
    }

    const TriangleMesh& mesh_;
    std::int64_t samples_;
    std::vector<double> areaUpTo_;
};

struct Farthest {
    double distanceMm = 0;
    Vec3 pointMm;
};

/// What the samples of one direction, or of both, give.
struct Measurements {
    std::vector<double> distancesMm;
    std::vector<double> deviationsDeg;
    Farthest farthest;
};

Vec3 triangleNormal(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return areaVector2(mesh.points[a], mesh.points[b], mesh.points[c]);
}

double angleDeg(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

void measureSamples(const TriangleMesh& from, const TriangleMesh& to, const AabbTree& tree,
                    std::int64_t samples, Measurements& result) {
    const SurfaceSampler sampler(from, samples);
    result.distancesMm.resize(samples);
    result.deviationsDeg.resize(samples);
    parallelForPieces(samples, kGrain, [&](std::int64_t begin, std::int64_t end) {
        std::int64_t hint = -1;  // neighbours among the samples are neighbours in space
        for (std::int64_t n = begin; n < end; ++n) {
            const SurfacePoint sample = sampler.at(n);
            const ClosestPoint nearest = tree.closestPoint(sample.pointMm, hint);
            result.distancesMm[n] = std::sqrt(nearest.squaredDistanceMm2);
            result.deviationsDeg[n] = angleDeg(triangleNormal(from, sample.triangle),
                                               triangleNormal(to, nearest.triangle));
            hint = nearest.triangle;
        }
    });
    const auto largest = std::max_element(result.distancesMm.begin(), result.distancesMm.end());
    result.farthest = {*largest, sampler.at(largest - result.distancesMm.begin()).pointMm};
}

/// The vertex farthest away; the first of several.
Farthest farthestVertex(const TriangleMesh& from, const AabbTree& tree) {
    std::vector<bool> isUsed(from.points.size());
    for (const Triangle& t : from.triangles) {
        for (const VertexId v : t) isUsed[v] = true;
    }
    const auto count = static_cast<std::int64_t>(from.points.size());
    std::vector<Farthest> ofPiece((count + kGrain - 1) / kGrain);
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        Farthest& farthest = ofPiece[begin / kGrain];
        std::int64_t hint = -1;
        for (VertexId v = begin; v < end; ++v) {
            if (!isUsed[v]) continue;
            const ClosestPoint nearest = tree.closestPoint(from.points[v], hint);
            hint = nearest.triangle;
            const double distanceMm = std::sqrt(nearest.squaredDistanceMm2);
            if (distanceMm > farthest.distanceMm) farthest = {distanceMm, from.points[v]};
        }
    });
    return *std::max_element(
        ofPiece.begin(), ofPiece.end(),
        [](const Farthest& l, const Farthest& r) { return l.distanceMm < r.distanceMm; });
}

Measurements measure(const TriangleMesh& from, const TriangleMesh& to, std::int64_t samples) {
    const AabbTree tree(to);
    Measurements result;
    measureSamples(from, to, tree, samples, result);
    const Farthest vertex = farthestVertex(from, tree);
    if (vertex.distanceMm > result.farthest.distanceMm) result.farthest = vertex;
    return result;
}

/// The nearest-rank percentile. Reorders `values`, which has at least one.
double percentile(std::vector<double>& values, double part) {
    const auto rank =
        static_cast<std::ptrdiff_t>(std::ceil(part * static_cast<double>(values.size())));
    const auto place = values.begin() + std::clamp<std::ptrdiff_t>(rank - 1, 0, values.size() - 1);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

/// Reorders the measurements.
DistanceStatistics summarize(Measurements& measurements) {
    DistanceStatistics result;
    std::vector<double>& distances = measurements.distancesMm;
    result.samples = static_cast<std::int64_t>(distances.size());
    result.meanMm = mean(distances);
    double squares = 0;
    for (const double distance : distances) squares += distance * distance;
    result.rmsMm = std::sqrt(squares / static_cast<double>(distances.size()));
    result.p95Mm = percentile(distances, 0.95);
    result.p99Mm = percentile(distances, 0.99);
    result.maxMm = measurements.farthest.distanceMm;
    result.maxPointMm = measurements.farthest.pointMm;
    result.meanNormalDeviationDeg = mean(measurements.deviationsDeg);
    result.p95NormalDeviationDeg = percentile(measurements.deviationsDeg, 0.95);
    return result;
}

void append(Measurements& all, const Measurements& more) {
    all.distancesMm.insert(all.distancesMm.end(), more.distancesMm.begin(), more.distancesMm.end());
    all.deviationsDeg.insert(all.deviationsDeg.end(), more.deviationsDeg.begin(),
                             more.deviationsDeg.end());
    if (more.farthest.distanceMm > all.farthest.distanceMm) all.farthest = more.farthest;
}

}  // namespace

DistanceReport surfaceDistance(const TriangleMesh& a, const TriangleMesh& b,
                               const DistanceOptions& options) {
    if (options.samples < 1) {
        throw InvalidInput("surfaceDistance: " + std::to_string(options.samples) +
                           " samples, must be at least 1");
    }
    requireMeasurable(a, "A");
    requireMeasurable(b, "B");
    const auto tell = [&](double fraction) {
        if (options.progress) options.progress("surface distance", fraction);
    };

    DistanceReport report;
    tell(0);
    Measurements all = measure(a, b, options.samples);
    report.aToB = summarize(all);
    if (options.isSymmetric) {
        tell(0.5);
        Measurements back = measure(b, a, options.samples);
        report.bToA = summarize(back);
        append(all, back);
    }
    report.combined = options.isSymmetric ? summarize(all) : report.aToB;
    tell(1);
    return report;
}

std::vector<double> vertexDistancesMm(const TriangleMesh& from, const TriangleMesh& to) {
    const AabbTree tree(to);
    std::vector<double> distances(from.points.size());
    parallelForPieces(std::ssize(from.points), kGrain, [&](std::int64_t begin, std::int64_t end) {
        std::int64_t hint = -1;
        for (std::int64_t v = begin; v < end; ++v) {
            const ClosestPoint nearest = tree.closestPoint(from.points[v], hint);
            distances[v] = std::sqrt(nearest.squaredDistanceMm2);
            hint = nearest.triangle;
        }
    });
    return distances;
}

}  // namespace adaptiso
