#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptive/collapse/ChangedStar.h"
#include "adaptive/mesh/MetricFrame.h"

namespace adaptiso::detail {

/// Which triangle of a patch stands for each sample of the full-resolution surface, and how far
/// off it is: the samples of the triangles that a change takes away are handed to the new ones.
class ErrorTracker {
public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    ErrorTracker(Patch& patch, const MetricFrame& frame);

    /// Measures how far the samples of an unchanged star are from their triangles.
    /// \return false when it touches places that must be tight
    bool measure(const ChangedStar& unchanged);

    /// Finds for every sample of the star's triangles the near one of the changed triangles.
    /// \return false when a sample would be farther than maxDistanceMm from it
    bool assign(const ChangedStar& changed, double maxDistanceMm);

    /// Of the last assign() or measure(): the sum of squared distances, mm2.
    double sumOfSquares() const { return sumOfSquares_; }
    /// Of the last assign() or measure(): the largest squared distance, mm2.
    double largestSquare() const { return largestSquare_; }
    /// Of the last assign(): the star comes so far towards other sheets that it could meet them.
    bool isCrowded() const { return isCrowded_; }

    /// Of the last assign(): all samples, one or more, know of no other sheet near them.
    bool isInSingleSheet() const { return !moves_.empty() && leastRoom_ == SheetRoom::kAlone; }

    /// Makes the last assign() true.
    void commit(const ChangedStar& changed);

    /// The samples of a triangle, as a list.
    std::uint32_t first(std::uint32_t triangle) const { return firstSample_[triangle]; }
    std::uint32_t next(std::uint32_t sample) const { return nextSample_[sample]; }

private:
    struct Move {
        std::uint32_t sample;
        int wedge;
    };
    template <class F>
    bool forEachTriangle(const Star& star, const F& f) const;
    Move nearest(const ChangedStar& changed, std::uint32_t sample, int start,
                 double& squaredDistance) const;

    const Sample& sampleNearest(const Vec3& p) const;
    bool ridgesAreNear(const ChangedStar& changed, double maxDistanceMm) const;

    Patch& patch_;
    double sampleSpacingMm_;
    static constexpr int kRooms = SheetRoom::kAlone + 1;
    std::array<double, kRooms> squaredRoom_{};  ///< that may be used, by Sample::room
    std::vector<std::uint32_t> firstSample_, nextSample_;
    std::vector<std::uint8_t> triangleRoom_;  ///< where there are no samples, see Sample
    std::vector<Move> moves_;
    std::array<std::vector<float>, 3> movedAlong_;  ///< positions of the moves' samples, by axis
    double sumOfSquares_ = 0, largestSquare_ = 0;
    std::uint8_t leastRoom_ = SheetRoom::kAlone;
    bool isCrowded_ = false;
};

}  // namespace adaptiso::detail
