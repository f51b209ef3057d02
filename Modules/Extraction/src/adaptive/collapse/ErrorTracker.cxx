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

/// A distance, larger where it must be small.
double tightened(double distanceMm, const Sample& sample) {
    return sample.tightness == 0 ? distanceMm : distanceMm * std::exp2(0.5 * sample.tightness);
}

}  // namespace

ErrorTracker::ErrorTracker(Patch& patch, const MetricFrame& frame)
    : patch_(patch),
      sampleSpacingMm_(frame.voxelMm()),
      firstSample_(patch.triangles.size(), kNone),
      nextSample_(patch.samples.size(), kNone),
      triangleRoom_(patch.triangles.size(), SheetRoom::kAlone) {
    for (int room = 0; room < kRooms; ++room) {
        const double voxels = static_cast<double>(room) / SheetRoom::kParts,
                     mm = kUsableRoom * voxels * frame.narrowestMm();
        squaredRoom_[room] = voxels < kNarrowRoom ? -1 : mm * mm;
    }
    squaredRoom_[SheetRoom::kAlone] = kInfinity;
    for (auto s = static_cast<std::uint32_t>(patch.samples.size()); s-- > 0;) {
        const std::uint32_t t = patch.sampleTriangle[s];
        nextSample_[s] = firstSample_[t];
        firstSample_[t] = s;
    }
}

/// Calls f(triangle, wedge that takes its place or lies beside it) until f returns false.
template <class F>
bool ErrorTracker::forEachTriangle(const Star& star, const F& f) const {
    for (int i = 0; i < star.count; ++i) {
        if (!f(star.triangle[i], i)) return false;
    }
    for (int i = 0; i < star.removedCount; ++i) {
        if (!f(star.removed[i], i == 0 ? 0 : star.secondWedge)) return false;
    }
    return true;
}

ErrorTracker::Move ErrorTracker::nearest(const ChangedStar& changed, std::uint32_t sample,
                                         int start, double& squaredDistance) const {
    // downhill from wedge to wedge, one way round
    const Vec3 q = patch_.samples[sample].point() - changed.vertex;
    const int n = changed.star.count;
    Move best{sample, start};
    squaredDistance = kInfinity;
    int direction = 0;
    for (int tries = 0, i = start; tries < n; ++tries) {
        const WedgeDistance found = distanceTo(changed.wedge[i], q);
        if (!(found.squared < squaredDistance)) break;
        squaredDistance = found.squared;
        best.wedge = i;
        if (found.towards == 0 || (direction != 0 && found.towards != direction)) break;
        direction = found.towards;
        i = (i + direction + n) % n;
    }
    return best;
}

bool ErrorTracker::measure(const ChangedStar& unchanged) {
    sumOfSquares_ = largestSquare_ = 0;
    return forEachTriangle(unchanged.star, [&](std::uint32_t triangle, int wedge) {
        for (std::uint32_t s = firstSample_[triangle]; s != kNone; s = nextSample_[s]) {
            const Sample& sample = patch_.samples[s];
            if (sample.tightness > 0) return false;
            const double squared =
                distanceTo(unchanged.wedge[wedge], sample.point() - unchanged.vertex).squared;
            sumOfSquares_ += squared;
            largestSquare_ = std::max(largestSquare_, squared);
        }
        return true;
    });
}

bool ErrorTracker::assign(const ChangedStar& changed, double maxDistanceMm) {
    const double most = maxDistanceMm * maxDistanceMm;
    moves_.clear();
    for (auto& along : movedAlong_) along.clear();
    sumOfSquares_ = largestSquare_ = 0;
    isCrowded_ = false;
    leastRoom_ = SheetRoom::kAlone;
    std::uint8_t roomUnseen = SheetRoom::kAlone;
    const bool isNear = forEachTriangle(changed.star, [&](std::uint32_t triangle, int wedge) {
        roomUnseen = std::min(roomUnseen, triangleRoom_[triangle]);
        for (std::uint32_t s = firstSample_[triangle]; s != kNone; s = nextSample_[s]) {
            double squared = 0;
            const Move move = nearest(changed, s, wedge, squared);
            const Sample& sample = patch_.samples[s];
            leastRoom_ = std::min(leastRoom_, sample.room);
            if (squared > squaredRoom_[sample.room]) isCrowded_ = true;
            if (!(squared <=
                  (sample.tightness == 0 ? most : std::ldexp(most, -sample.tightness)))) {
                return false;
            }
            sumOfSquares_ += squared;
            largestSquare_ = std::max(largestSquare_, squared);
            moves_.push_back(move);
            for (int a = 0; a < 3; ++a) movedAlong_[a].push_back(sample.position[a]);
        }
        return true;
    });
    leastRoom_ = std::min(leastRoom_, roomUnseen);
    if (!isNear) return false;
    if (moves_.empty()) {
        isCrowded_ = leastRoom_ != SheetRoom::kAlone;
        return true;
    }
    const Sample& nearest = sampleNearest(changed.vertex);
    const double height = heightOver(nearest, changed.vertex);
    if (height * height > squaredRoom_[std::min(nearest.room, roomUnseen)]) isCrowded_ = true;
    return tightened(height, nearest) <= maxDistanceMm && ridgesAreNear(changed, maxDistanceMm);
}

/// Of the samples of the last assign(), but for differences of a ten-thousandth.
const Sample& ErrorTracker::sampleNearest(const Vec3& p) const {
    // a number of 32 bits for each, by which the compiler takes several at once: the square, as
    // floats that are not negative sort by their bits, with the place in its last bits
    constexpr std::int32_t kPlaces = 1 << 10;
    const std::array<float, 3> q = Sample::positionOf(p);
    const auto count = static_cast<std::int32_t>(moves_.size());
    std::int32_t at = 0, least = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t begin = 0; begin < count; begin += kPlaces) {
        const std::int32_t here = std::min(kPlaces, count - begin);
        const float *xs = movedAlong_[0].data() + begin, *ys = movedAlong_[1].data() + begin,
                    *zs = movedAlong_[2].data() + begin;
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
    return patch_.samples[moves_[at].sample];
}

/// The way back: a sharp edge may pass between the samples of a rounder surface.
bool ErrorTracker::ridgesAreNear(const ChangedStar& changed, double maxDistanceMm) const {
    const int n = changed.star.count;
    const auto normal = [&](int i) {
        const ChangedStar::Wedge& w = changed.wedge[i];
        return std::sqrt(w.inverse) * cross(w.e1, w.e2);
    };
    Vec3 before = normal(n - 1);
    for (int i = 0; i < n; ++i) {
        const Vec3 after = normal(i);
        const bool isSharp = dot(before, after) < kRidgeCosine;
        before = after;
        if (!isSharp) continue;
        const Vec3& spoke = changed.wedge[i].e1;
        const int steps =
            std::min(kRidgeMostSteps,
                     1 + static_cast<int>(norm(spoke) / (kRidgeSpacing * sampleSpacingMm_)));
        for (int k = 1; k < steps; ++k) {
            const Vec3 p = changed.vertex + static_cast<double>(k) / steps * spoke;
            const Sample& nearest = sampleNearest(p);
            if (tightened(heightOver(nearest, p), nearest) > maxDistanceMm) {
                return false;
            }
        }
    }
    return true;
}

void ErrorTracker::commit(const ChangedStar& changed) {
    forEachTriangle(changed.star, [&](std::uint32_t triangle, int) {
        firstSample_[triangle] = kNone;
        return true;
    });
    for (const Move& move : moves_) {
        const std::uint32_t t = changed.star.triangle[move.wedge];
        nextSample_[move.sample] = firstSample_[t];
        firstSample_[t] = move.sample;
        patch_.sampleTriangle[move.sample] = t;
    }
    for (int i = 0; i < changed.star.count; ++i) {  // what lies around it tells
        const std::uint32_t t = changed.star.triangle[i];
        if (firstSample_[t] == kNone) triangleRoom_[t] = leastRoom_;
    }
}

}  // namespace adaptiso::detail
