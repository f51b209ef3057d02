#include "ErrorTracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

}  // namespace

ErrorTracker::ErrorTracker(Patch& patch, double sampleSpacingMm)
    : patch_(patch),
      sampleSpacingMm_(sampleSpacingMm),
      firstSample_(patch.triangles.size(), kNone),
      nextSample_(patch.samples.size(), kNone),
      triangleIsCrowded_(patch.triangles.size(), 0) {
    for (auto s = static_cast<std::uint32_t>(patch.samples.size()); s-- > 0;) {
        const std::uint32_t t = patch.sampleTriangle[s];
        nextSample_[s] = firstSample_[t];
        firstSample_[t] = s;
        if (!patch.samples[s].isSingleSheet) triangleIsCrowded_[t] = 1;
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

bool ErrorTracker::assign(const ChangedStar& changed, double maxDistanceMm) {
    const double most = maxDistanceMm * maxDistanceMm;
    moves_.clear();
    movedPositions_.clear();
    sumOfSquares_ = largestSquare_ = 0;
    isCrowded_ = isTight_ = false;
    const bool isNear = forEachTriangle(changed.star, [&](std::uint32_t triangle, int wedge) {
        if (triangleIsCrowded_[triangle] != 0) isCrowded_ = true;
        for (std::uint32_t s = firstSample_[triangle]; s != kNone; s = nextSample_[s]) {
            double squared = 0;
            const Move move = nearest(changed, s, wedge, squared);
            const Sample& sample = patch_.samples[s];
            if (sample.tightness > 0) isTight_ = true;
            if (!(squared <=
                  (sample.tightness == 0 ? most : std::ldexp(most, -sample.tightness)))) {
                return false;
            }
            sumOfSquares_ += squared;
            largestSquare_ = std::max(largestSquare_, squared);
            moves_.push_back(move);
            movedPositions_.push_back(sample.position);
        }
        return true;
    });
    return isNear && (moves_.empty() || (heightAt(changed.vertex) <= maxDistanceMm &&
                                         ridgesAreNear(changed, maxDistanceMm)));
}

/// About how far a point lies from the full-resolution surface, larger where that must be tight:
/// its height over the tangent plane at the nearest sample of the last assign().
double ErrorTracker::heightAt(const Vec3& p) const {
    const std::array<float, 3> q = Sample::positionOf(p);
    float nearest = std::numeric_limits<float>::infinity();
    std::size_t at = 0;
    for (std::size_t i = 0; i < movedPositions_.size(); ++i) {
        const auto& s = movedPositions_[i];
        const float x = s[0] - q[0], y = s[1] - q[1], z = s[2] - q[2];
        const float squared = x * x + y * y + z * z;
        if (squared < nearest) {
            nearest = squared;
            at = i;
        }
    }
    const Sample& sample = patch_.samples[moves_[at].sample];
    const double height = std::abs(dot(sample.normal(), p - sample.point()));
    return sample.tightness == 0 ? height : height * std::exp2(0.5 * sample.tightness);
}

/// The way back: a sharp edge may pass between the samples of a rounder surface.
bool ErrorTracker::ridgesAreNear(const ChangedStar& changed, double maxDistanceMm) const {
    constexpr double kSharpCosine = 0.95, kSpacing = 0.5;
    constexpr int kMostSteps = 16;
    const int n = changed.star.count;
    const auto normal = [&](int i) {
        const ChangedStar::Wedge& w = changed.wedge[i];
        return std::sqrt(w.inverse) * cross(w.e1, w.e2);
    };
    Vec3 before = normal(n - 1);
    for (int i = 0; i < n; ++i) {
        const Vec3 after = normal(i);
        const bool isSharp = dot(before, after) < kSharpCosine;
        before = after;
        if (!isSharp) continue;
        const Vec3& spoke = changed.wedge[i].e1;
        const int steps =
            std::min(kMostSteps, 1 + static_cast<int>(norm(spoke) / (kSpacing * sampleSpacingMm_)));
        for (int k = 1; k < steps; ++k) {
            if (heightAt(changed.vertex + static_cast<double>(k) / steps * spoke) > maxDistanceMm) {
                return false;
            }
        }
    }
    return true;
}

void ErrorTracker::commit(const ChangedStar& changed) {
    forEachTriangle(changed.star, [&](std::uint32_t triangle, int) {
        firstSample_[triangle] = kNone;
        triangleIsCrowded_[triangle] = 0;
        return true;
    });
    for (const Move& move : moves_) {
        const std::uint32_t t = changed.star.triangle[move.wedge];
        nextSample_[move.sample] = firstSample_[t];
        firstSample_[t] = move.sample;
        patch_.sampleTriangle[move.sample] = t;
        if (!patch_.samples[move.sample].isSingleSheet) triangleIsCrowded_[t] = 1;
    }
    if (!isCrowded_) return;
    for (int i = 0; i < changed.star.count; ++i) {  // without samples: nothing says it is not
        const std::uint32_t t = changed.star.triangle[i];
        if (firstSample_[t] == kNone) triangleIsCrowded_[t] = 1;
    }
}

}  // namespace adaptiso::detail
