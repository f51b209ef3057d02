#include "adaptiso/MeshQuality/SurfaceDistance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "NumberedTriangles.h"
#include "Percentile.h"
#include "TriangleGroups.h"
#include "Triangles.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {

namespace {

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

/// Statistics of the samples of one direction, or of both.
struct Measurements {
    std::vector<double> distancesMm;
    std::vector<double> deviationsDeg;
    Farthest farthest;
    RoughDistances rough;
    std::int64_t leftOut = 0, leftOutVertices = 0;
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
    std::vector<StandIn> standIns;
    result.rough += findNearestPlaces(
        to, tree, samples, [&](std::int64_t n) { return sampler.at(n).pointMm; },
        [&](std::int64_t n, const ClosestPoint& nearest) {
            result.distancesMm[n] = std::sqrt(nearest.squaredDistanceMm2);
            result.deviationsDeg[n] = angleDeg(triangleNormal(from, sampler.at(n).triangle),
                                               triangleNormal(to, nearest.triangle));
        },
        true, &standIns);
    for (const auto& [point, like] : standIns) result.distancesMm[point] = 0;
    const auto largest = std::max_element(result.distancesMm.begin(), result.distancesMm.end());
    result.farthest = {*largest, sampler.at(largest - result.distancesMm.begin()).pointMm};
    for (const auto& [point, like] : standIns) {
        result.distancesMm[point] = result.distancesMm[like];
        result.deviationsDeg[point] = result.deviationsDeg[like];
    }
    result.leftOut = std::ssize(standIns);
}

/// The vertex farthest away; the first of several.
Farthest farthestVertex(const TriangleMesh& from, const TriangleMesh& to, const AabbTree& tree,
                        Measurements& result) {
    std::vector<bool> isUsed(from.points.size());
    for (const Triangle& t : from.triangles) {
        for (const VertexId v : t) isUsed[v] = true;
    }
    std::vector<double> squared(from.points.size());
    std::vector<StandIn> standIns;
    result.rough += findNearestPlaces(
        to, tree, std::ssize(from.points),
        [&](VertexId v) { return isUsed[v] ? std::optional(from.points[v]) : std::nullopt; },
        [&](VertexId v, const ClosestPoint& nearest) { squared[v] = nearest.squaredDistanceMm2; },
        true, &standIns);
    result.leftOutVertices = std::ssize(standIns);
    const auto farthest = std::max_element(squared.begin(), squared.end());
    return {std::sqrt(*farthest), from.points[farthest - squared.begin()]};
}

Measurements measure(const TriangleMesh& from, const TriangleMesh& to, std::int64_t samples) {
    const AabbTree tree(to);
    Measurements result;
    measureSamples(from, to, tree, samples, result);
    const Farthest vertex = farthestVertex(from, to, tree, result);
    if (vertex.distanceMm > result.farthest.distanceMm) result.farthest = vertex;
    return result;
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
    result.leftOut = measurements.leftOut;
    result.leftOutVertices = measurements.leftOutVertices;
    if (result.leftOut > 0) {
        const double variance = std::max(
            0.0, squares / static_cast<double>(distances.size()) - result.meanMm * result.meanMm);
        result.meanErrorMm = 2 * std::sqrt(variance / static_cast<double>(result.measured()));
    }
    result.p95Mm = percentile(distances, 0.95);
    result.p99Mm = percentile(distances, 0.99);
    result.rough = measurements.rough;
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
    all.rough += more.rough;
    all.leftOut += more.leftOut;
    all.leftOutVertices += more.leftOutVertices;
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

double measuringErrorMm(const TriangleMesh& mesh) {
    return surfaceDistance(mesh, mesh, {.isSymmetric = false}).combined.maxMm;
}

std::vector<double> vertexDistancesMm(const TriangleMesh& from, const TriangleMesh& to) {
    const AabbTree tree(to);
    std::vector<double> distances(from.points.size());
    findNearestPlaces(
        to, tree, std::ssize(from.points), [&](VertexId v) { return from.points[v]; },
        [&](VertexId v, const ClosestPoint& nearest) {
            distances[v] = std::sqrt(nearest.squaredDistanceMm2);
        });
    return distances;
}

namespace {

constexpr std::int64_t kGapGrain = 1024;
/// Bounds below and distances are both rounded: a pair is passed over only when its bound is
/// larger by more than that, so that every pair at the smallest distance is looked at.
constexpr double kSlack = 1 + 1e-12;

struct Best {
    double squared = std::numeric_limits<double>::infinity();
    Vec3 a, b;

    void offer(const Vec3& p, const Vec3& q) {
        const double candidate = squaredNorm(p - q);
        if (candidate < squared) *this = {candidate, p, q};
    }
};

/// The nearest points of two segments [Ericson2005, section 5.1.9].
void offerSegments(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2, Best& best) {
    const Vec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
    const double a = squaredNorm(d1), e = squaredNorm(d2), f = dot(d2, r);
    const double b = dot(d1, d2), c = dot(d1, r);
    if (!(a > 0) || !(e > 0)) return;  // a point: the corners' turn
    const double denominator = a * e - b * b;
    double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0;
    double t = (b * s + f) / e;
    if (t < 0) {
        t = 0;
        s = std::clamp(-c / a, 0.0, 1.0);
    } else if (t > 1) {
        t = 1;
        s = std::clamp((b - c) / a, 0.0, 1.0);
    }
    best.offer(p1 + s * d1, p2 + t * d2);
}

/// The point where a segment passes the triangle's plane, if it does, and the nearest of the
/// triangle: one point where the segment goes through.
template <class Offer>
void offerPassage(const Vec3& p, const Vec3& q, const Corners& t, const Offer& offer) {
    const Vec3 normal = areaVector2(t[0], t[1], t[2]);
    const double hp = dot(normal, p - t[0]), hq = dot(normal, q - t[0]);
    if (!(hp * hq <= 0) || hp == hq) return;
    const Vec3 x = p + hp / (hp - hq) * (q - p);
    offer(x, closestPointOnTriangle(x, t[0], t[1], t[2]));
}

Best nearestPoints(const Corners& a, const Corners& b) {
    Best best;
    for (int n = 0; n < 3; ++n) {
        best.offer(a[n], closestPointOnTriangle(a[n], b[0], b[1], b[2]));
        best.offer(closestPointOnTriangle(b[n], a[0], a[1], a[2]), b[n]);
        for (int m = 0; m < 3; ++m) {
            offerSegments(a[n], a[(n + 1) % 3], b[m], b[(m + 1) % 3], best);
        }
    }
    return best;
}

/// A point that two triangles have in common, as nearly as doubles tell.
Best commonPoint(const Corners& a, const Corners& b) {
    Best best = nearestPoints(a, b);
    for (int n = 0; n < 3; ++n) {
        offerPassage(a[n], a[(n + 1) % 3], b,
                     [&](const Vec3& x, const Vec3& y) { best.offer(x, y); });
        offerPassage(b[n], b[(n + 1) % 3], a,
                     [&](const Vec3& x, const Vec3& y) { best.offer(y, x); });
    }
    best.b = best.a;
    best.squared = 0;
    return best;
}

/// True if a slab across the line along `across` that lies between the triangles is thicker than
/// the root of `squaredReach`.
bool isSlabThicker(const Vec3& across, const Corners& a, const Corners& b, double squaredReach) {
    const double high = std::max(std::max(dot(across, a[0]), dot(across, a[1])), dot(across, a[2]));
    const double low = std::min(std::min(dot(across, b[0]), dot(across, b[1])), dot(across, b[2]));
    // both are rounded by some 1e-15 of their size
    const double gap = low - high - 1e-14 * (std::abs(low) + std::abs(high));
    return gap > 0 && gap * gap > squaredReach * squaredNorm(across);
}

/// The corner farthest along a direction.
const Vec3& support(const Corners& t, const Vec3& along) {
    const double h0 = dot(along, t[0]), h1 = dot(along, t[1]), h2 = dot(along, t[2]);
    return h0 >= h1 ? (h0 >= h2 ? t[0] : t[2]) : (h1 >= h2 ? t[1] : t[2]);
}

/// True if two triangles surely lie further apart than the root of `squaredReach`: first steps of
/// [Gilbert1988]. Tight for triangles that face each other, where boxes are not.
bool areFartherThan(double squaredReach, const Corners& a, const Corners& b) {
    const Vec3 across = (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2]);
    if (isSlabThicker(across, a, b, squaredReach)) return true;
    return isSlabThicker(support(b, -across) - support(a, across), a, b, squaredReach);
}

/// A reach to begin with: the smallest distance of some vertices of `a` to `b`.
double firstReach(const TriangleMesh& a, const AabbTree& treeB) {
    constexpr std::int64_t kProbes = 512;
    const std::int64_t count = std::ssize(a.triangles);
    double reach = std::numeric_limits<double>::infinity();
    for (std::int64_t n = 0; n < count; n += std::max<std::int64_t>(1, count / kProbes)) {
        const Corners corners = cornersOf(a, n);
        if (!areFinite(corners)) continue;
        reach = std::min(reach, treeB.closestPoint(corners[0]).squaredDistanceMm2);
    }
    return reach;
}

constexpr std::int64_t kGroup = 4;  // a leaf of the tree

/// Triangles that lie near each other.
struct Group {
    Group(const TriangleMesh& mesh, const AabbTree& tree, std::span<const std::int64_t> numbers)
        : triangles(numbers), count(std::ssize(numbers)), box(tree.triangleBox(numbers[0])) {
        for (std::int64_t n = 0; n < count; ++n) {
            corners[n] = cornersOf(mesh, numbers[n]);
            box.add(tree.triangleBox(numbers[n]));
        }
    }

    std::span<const std::int64_t> triangles;
    std::int64_t count;
    BoundingBox box;
    std::array<Corners, kGroup> corners;
};

struct GapCandidate {
    double squared = std::numeric_limits<double>::infinity();
    std::int64_t triangleA = -1, triangleB = -1;

    bool operator<(const GapCandidate& other) const {
        return std::tie(squared, triangleA, triangleB) <
               std::tie(other.squared, other.triangleA, other.triangleB);
    }
};

}  // namespace

NearestPoints triangleDistance(const Corners& a, const Corners& b) {
    const Best best = trianglesMeet(a, b) ? commonPoint(a, b) : nearestPoints(a, b);
    return {std::sqrt(best.squared), best.a, best.b};
}

namespace {

/// The nearest of pairs that boxes do not tell from it. \return empty where these are too many
std::optional<GapCandidate> nearestByBoxes(const TriangleMesh& a, const AabbTree& treeA,
                                           const TriangleMesh& b, const AabbTree& treeB,
                                           double reach) {
    constexpr std::int64_t kMost = 512 * kGapGrain;  // pairs to look at, of a piece
    // neighbours in the tree's order are asked for together
    const std::span<const std::int64_t> triangles = treeA.triangles();
    const std::int64_t pieces = (std::ssize(triangles) + kGapGrain - 1) / kGapGrain;
    std::vector<GapCandidate> ofPiece(static_cast<std::size_t>(pieces));
    std::atomic<bool> areTooMany = false;
    const auto search = [&](std::int64_t piece) {
        GapCandidate best;
        std::int64_t looks = 0;
        const std::int64_t begin = piece * kGapGrain,
                           end = std::min<std::int64_t>(begin + kGapGrain, std::ssize(triangles));
        const auto slackReach = [&] {
            return looks > kMost ? -1 : kSlack * std::min(reach, best.squared);
        };
        for (std::int64_t i = begin; i < end && looks <= kMost && !areTooMany; i += kGroup) {
            const Group group(a, treeA, triangles.subspan(i, std::min(kGroup, end - i)));
            treeB.forEachNear(group.box, slackReach, [&](std::int64_t other) {
                looks += group.count;
                const Corners others = cornersOf(b, other);
                for (std::int64_t n = 0; n < group.count; ++n) {
                    const Corners& corners = group.corners[n];
                    if (areFartherThan(slackReach(), corners, others)) continue;
                    const double squared =
                        trianglesMeet(corners, others) ? 0 : nearestPoints(corners, others).squared;
                    best = std::min(best, {squared, group.triangles[n], other});
                }
            });
        }
        if (looks > kMost) areTooMany = true;
        ofPiece[piece] = best;
    };
    // pieces learn from the rounds before alone, so that what they look at depends on no thread
    for (std::int64_t begin = 0, size = 1; begin < pieces; begin += size, size *= 2) {
        const std::int64_t count = std::min(size, pieces - begin);
        parallelForPieces(count, 1, [&](std::int64_t n, std::int64_t) { search(begin + n); });
        if (areTooMany) return std::nullopt;
        for (std::int64_t n = begin; n < begin + count; ++n) {
            reach = std::min(reach, ofPiece[n].squared);
        }
    }
    const auto best = std::min_element(ofPiece.begin(), ofPiece.end());
    return best == ofPiece.end() ? GapCandidate{} : *best;
}

/// The smallest squared distance of the vertices of `a` to `b`.
double vertexReach(const TriangleMesh& a, const TriangleMesh& b, const AabbTree& treeB) {
    std::vector<double> squared(a.points.size(), std::numeric_limits<double>::infinity());
    std::vector<bool> isUsed(a.points.size());
    for (std::int64_t n = 0; n < std::ssize(a.triangles); ++n) {
        if (!areFinite(cornersOf(a, n))) continue;
        for (const VertexId v : a.triangles[n]) isUsed[v] = true;
    }
    findNearestPlaces(
        b, treeB, std::ssize(a.points),
        [&](VertexId v) { return isUsed[v] ? std::optional(a.points[v]) : std::nullopt; },
        [&](VertexId v, const ClosestPoint& nearest) { squared[v] = nearest.squaredDistanceMm2; });
    return *std::min_element(squared.begin(), squared.end());
}

/// The same by groups that planes tell apart.
/// \param reach       that some pair has, squared
/// \param isComplete  becomes false where these are more than their budget allows
GapCandidate nearestByGroups(const TriangleMesh& a, const AabbTree& treeA, const TriangleMesh& b,
                             const AabbTree& treeB, double reach, bool& isComplete) {
    reach = std::min({reach, vertexReach(a, b, treeB), vertexReach(b, a, treeA)});
    const NumberedTriangles ours(a), theirs(b);
    const TriangleView viewA = ours.view(), viewB = theirs.view();
    GapCandidate best;
    std::mutex guard;
    const auto look = [&](std::uint32_t s, std::uint32_t t) {
        const Corners corners = viewA.cornersOf(s), others = viewB.cornersOf(t);
        if (areFartherThan(kSlack * reach, corners, others)) return false;
        const double squared =
            trianglesMeet(corners, others) ? 0 : nearestPoints(corners, others).squared;
        const std::lock_guard lock(guard);
        best = std::min(best, {squared, ours.numbers[s], theirs.numbers[t]});
        return false;
    };
    const TriangleGroups::Pairs found =
        TriangleGroups(viewA, false)
            .findPairs(TriangleGroups(viewB, false), kSlack * std::sqrt(reach), look);
    isComplete = found.undecided.empty() && found.otherUndecided.empty();
    return best;
}

}  // namespace

SurfaceGap surfaceGap(const TriangleMesh& a, const AabbTree& treeA, const TriangleMesh& b,
                      const AabbTree& treeB) {
    const double reach = firstReach(a, treeB);
    SurfaceGap gap;
    std::optional<GapCandidate> best = nearestByBoxes(a, treeA, b, treeB, reach);
    if (!best) best = nearestByGroups(a, treeA, b, treeB, reach, gap.isComplete);
    if (best->triangleA < 0) return gap;
    gap.nearest = triangleDistance(cornersOf(a, best->triangleA), cornersOf(b, best->triangleB));
    gap.triangleA = best->triangleA;
    gap.triangleB = best->triangleB;
    return gap;
}

}  // namespace adaptiso
