#include "adaptive/collapse/ErrorTracker.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Squared distance from q to the segment from the origin to e.
double squaredDistanceToSegment(const Vec3& q, const Vec3& e) {
    const double t = std::clamp(dot(q, e) / squaredNorm(e), 0.0, 1.0);
    return squaredNorm(q - t * e);
}

struct WedgeDistance {
    double squared;
    int towards;  ///< the neighbouring wedge that may be nearer: -1, 1, or 0 for none
};

/// From a point, seen from the star's vertex, to a triangle of the star.
WedgeDistance distanceTo(const ChangedStar::Wedge& w, const Vec3& q) {
    const double d1 = dot(q, w.e1), d2 = dot(q, w.e2);
    const double u = (w.a22 * d1 - w.a12 * d2) * w.inverse,
                 v = (w.a11 * d2 - w.a12 * d1) * w.inverse;
    if (u >= 0 && v >= 0 && u + v <= 1) {
        return {std::max(0.0, squaredNorm(q) - u * d1 - v * d2), 0};
    }
    WedgeDistance result{kInfinity, 0};
    if (u < 0) result = {squaredDistanceToSegment(q, w.e2), 1};
    if (v < 0) {
        const double squared = squaredDistanceToSegment(q, w.e1);
        if (squared < result.squared) result = {squared, -1};
    }
    if (u + v > 1) {
        result.squared = std::min(result.squared, squaredDistanceToSegment(q - w.e1, w.e2 - w.e1));
    }
    return result;
}

/// About how far a point lies from the full-resolution surface: its height over the tangent plane.
double heightOver(const Sample& sample, const Vec3& p) {
    return std::abs(dot(sample.normal(), p - sample.point()));
}

/// A distance from a sample, in proportion to the sample's tolerance: to be compared with the
/// allowed distance of samples that are in no web.
double scaled(double distanceMm, const Sample& sample) {
    return sample.isInWeb ? distanceMm * std::exp2(0.5 * kWebHalvings) : distanceMm;
}

}  // namespace

void SampleAssignment::clear() {
    moves.clear();
    for (auto& along : position) along.clear();
    sumOfSquares = largestSquare = 0;
    leastClearance = clearanceUnseen = SheetClearance::kAlone;
    isCrowded = false;
}

ErrorTracker::ErrorTracker(Patch& patch, const MetricFrame& frame)
    : patch_(patch),
      sampleSpacingMm_(frame.voxelMm()),
      firstSample_(patch.triangles.size(), kNone),
      nextSample_(patch.samples.size(), kNone),
      triangleClearance_(patch.triangles.size(), SheetClearance::kAlone) {
    for (int clearance = 0; clearance < kClearances; ++clearance) {
        const double voxels = static_cast<double>(clearance) / SheetClearance::kParts,
                     mm = kUsableClearance * voxels * frame.narrowestMm();
        squaredClearance_[clearance] = clearance == 0 ? -1 : mm * mm;
    }
    squaredClearance_[SheetClearance::kAlone] = kInfinity;
    for (auto s = static_cast<std::uint32_t>(patch.samples.size()); s-- > 0;) {
        const std::uint32_t t = patch.sampleTriangle[s];
        nextSample_[s] = firstSample_[t];
        firstSample_[t] = s;
    }
}

/// Calls f(triangle, wedge that takes its place or lies beside it).
template <class F>
void ErrorTracker::forEachTriangle(const Star& star, const F& f) {
    for (int i = 0; i < star.count; ++i) f(star.triangle[i], i);
    for (int i = 0; i < star.removedCount; ++i) f(star.removed[i], star.beside[i]);
}

SampleAssignment::Move ErrorTracker::nearest(const ChangedStar& changed, std::uint32_t sample,
                                             int start, double& squaredDistance) const {
    // downhill from wedge to wedge, one way round
    const Vec3 q = patch_.samples[sample].point() - changed.vertex;
    const int n = changed.star.count;
    SampleAssignment::Move best{sample, start};
    squaredDistance = kInfinity;
    int direction = 0;
    for (int tries = 0, i = start; tries < n; ++tries) {
        const WedgeDistance found = distanceTo(changed.wedge[i], q);
        if (!(found.squared < squaredDistance)) break;
        squaredDistance = found.squared;
        best.wedge = i;
        if (found.towards == 0 || (direction != 0 && found.towards != direction)) break;
        direction = found.towards;
        i += direction;
        if (changed.star.isOpen && (i < 0 || i == n)) break;
        i = (i + n) % n;
    }
    return best;
}

std::optional<StarFit> ErrorTracker::measure(const ChangedStar& unchanged) const {
    StarFit fit;
    bool isLoose = true;
    forEachTriangle(unchanged.star, [&](std::uint32_t triangle, int wedge) {
        for (std::uint32_t s = firstSample_[triangle]; s != kNone && isLoose; s = nextSample_[s]) {
            const Sample& sample = patch_.samples[s];
            isLoose = !sample.isInWeb;
            const double squared =
                distanceTo(unchanged.wedge[wedge], sample.point() - unchanged.vertex).squared;
            fit.sumOfSquares += squared;
            fit.largestSquare = std::max(fit.largestSquare, squared);
        }
    });
    return isLoose ? std::optional(fit) : std::nullopt;
}

Refusal ErrorTracker::assign(const ChangedStar& changed, double maxDistanceMm,
                             SampleAssignment& result) const {
    collect(changed.star, result);
    // points of the star first: more changes fail by them, and they take less time
    if (!vertexIsNear(changed, maxDistanceMm, result)) return Refusal::VertexFar;
    if (!ridgesAreNear(changed, result, maxDistanceMm)) return Refusal::RidgeFar;
    const bool areNear = samplesAreNear(changed, maxDistanceMm * maxDistanceMm, result);
    return areNear ? Refusal::None : Refusal::SampleFar;
}

/// The star's samples, each with the wedge to look at first.
void ErrorTracker::collect(const Star& star, SampleAssignment& result) const {
    result.clear();
    forEachTriangle(star, [&](std::uint32_t triangle, int wedge) {
        result.clearanceUnseen = std::min(result.clearanceUnseen, triangleClearance_[triangle]);
        for (std::uint32_t s = firstSample_[triangle]; s != kNone; s = nextSample_[s]) {
            const Sample& sample = patch_.samples[s];
            result.leastClearance = std::min(result.leastClearance, sample.clearance);
            result.moves.push_back({s, wedge});
            for (int a = 0; a < 3; ++a) result.position[a].push_back(sample.position[a]);
        }
    });
    result.leastClearance = std::min(result.leastClearance, result.clearanceUnseen);
}

/// The new vertex is near the full-resolution surface, by its nearest sample.
bool ErrorTracker::vertexIsNear(const ChangedStar& changed, double maxDistanceMm,
                                SampleAssignment& result) const {
    if (result.moves.empty()) {
        result.isCrowded = result.leastClearance != SheetClearance::kAlone;
        return true;
    }
    const Sample& nearest = sampleNearest(changed.vertex, result);
    const double height = heightOver(nearest, changed.vertex);
    result.isCrowded =
        height * height > squaredClearance_[std::min(nearest.clearance, result.clearanceUnseen)];
    return scaled(height, nearest) <= maxDistanceMm;
}

/// Hands each sample to the near one of the changed triangles.
bool ErrorTracker::samplesAreNear(const ChangedStar& changed, double most,
                                  SampleAssignment& result) const {
    for (SampleAssignment::Move& move : result.moves) {
        double squared = 0;
        move = nearest(changed, move.sample, move.wedge, squared);
        const Sample& sample = patch_.samples[move.sample];
        if (!(squared <= (sample.isInWeb ? std::ldexp(most, -kWebHalvings) : most)) ||
            (sample.isOnBorder && !borderIsNear(changed, move, most))) {
            return false;
        }
        if (squared > squaredClearance_[sample.clearance]) result.isCrowded = true;
        result.sumOfSquares += squared;
        result.largestSquare = std::max(result.largestSquare, squared);
    }
    return true;
}

/// A sample on the border is near what the border becomes, not just the surface.
bool ErrorTracker::borderIsNear(const ChangedStar& changed, const SampleAssignment::Move& move,
                                double squaredLimit) const {
    if (!changed.star.isOpen) return true;
    const Vec3 q = patch_.samples[move.sample].point() - changed.vertex;
    const ChangedStar::Wedge& own = changed.wedge[move.wedge];
    return squaredDistanceToSegment(q, changed.wedge[0].e1) <= squaredLimit ||
           squaredDistanceToSegment(q, changed.wedge[changed.star.count - 1].e2) <= squaredLimit ||
           squaredDistanceToSegment(q - own.e1, own.e2 - own.e1) <= squaredLimit;
}

/// Nearest of the samples that are handed over, but for differences of a ten-thousandth.
const Sample& ErrorTracker::sampleNearest(const Vec3& p, const SampleAssignment& assignment) const {
    // a number of 32 bits for each, by which the compiler takes several at once: the square, as
    // floats that are not negative sort by their bits, with the place in its last bits
    constexpr std::int32_t kPlaces = 1 << 10;
    const std::array<float, 3> q = Sample::positionOf(p);
    const auto count = static_cast<std::int32_t>(assignment.moves.size());
    std::int32_t at = 0, least = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t begin = 0; begin < count; begin += kPlaces) {
        const std::int32_t here = std::min(kPlaces, count - begin);
        const float *xs = assignment.position[0].data() + begin,
                    *ys = assignment.position[1].data() + begin,
                    *zs = assignment.position[2].data() + begin;
        std::int32_t best = std::numeric_limits<std::int32_t>::max();
        for (std::int32_t i = 0; i < here; ++i) {
            const float x = xs[i] - q[0], y = ys[i] - q[1], z = zs[i] - q[2];
            const auto bits = std::bit_cast<std::int32_t>(x * x + y * y + z * z);
            best = std::min(best, (bits & ~(kPlaces - 1)) | i);
        }
        if ((best & ~(kPlaces - 1)) < (least & ~(kPlaces - 1))) {
            least = best;
            at = begin + (best & (kPlaces - 1));
        }
    }
    return patch_.samples[assignment.moves[at].sample];
}

/// The way back: a sharp edge may pass between the samples of a rounder surface.
bool ErrorTracker::ridgesAreNear(const ChangedStar& changed, const SampleAssignment& assignment,
                                 double maxDistanceMm) const {
    if (assignment.moves.empty()) return true;
    const int n = changed.star.count;
    const int first = changed.star.isOpen ? 1 : 0;  // the spoke between two triangles
    const double spacingMm = kRidgeSpacing * std::max(sampleSpacingMm_, maxDistanceMm);
    for (int i = first; i < n; ++i) {
        const ChangedStar::Wedge &before = changed.wedge[i == 0 ? n - 1 : i - 1],
                                 &after = changed.wedge[i];
        const bool isSharp =
            dot(before.area2, after.area2) < kRidgeCosine * before.length * after.length;
        if (!isSharp) continue;
        const Vec3& spoke = changed.wedge[i].e1;
        const int steps = std::min(kRidgeMostSteps, 1 + static_cast<int>(norm(spoke) / spacingMm));
        for (int k = 1; k < steps; ++k) {
            const Vec3 p = changed.vertex + static_cast<double>(k) / steps * spoke;
            const Sample& nearest = sampleNearest(p, assignment);
            if (scaled(heightOver(nearest, p), nearest) > maxDistanceMm) {
                return false;
            }
        }
    }
    return true;
}

void ErrorTracker::commit(const ChangedStar& changed, const SampleAssignment& assignment) {
    forEachTriangle(changed.star,
                    [&](std::uint32_t triangle, int) { firstSample_[triangle] = kNone; });
    for (const SampleAssignment::Move& move : assignment.moves) {
        const std::uint32_t t = changed.star.triangle[move.wedge];
        nextSample_[move.sample] = firstSample_[t];
        firstSample_[t] = move.sample;
        patch_.sampleTriangle[move.sample] = t;
    }
    // a triangle without samples has the clearance of those around it
    for (int i = 0; i < changed.star.count; ++i) {
        const std::uint32_t t = changed.star.triangle[i];
        if (firstSample_[t] == kNone) triangleClearance_[t] = assignment.leastClearance;
    }
}

}  // namespace adaptiso::detail
