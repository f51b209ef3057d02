#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adaptive/collapse/ChangedStar.h"
#include "adaptive/mesh/MetricFrame.h"

namespace adaptiso::detail {

/// Reassignment of a changed star's samples: the new triangle that each one is handed to, and its
/// distance to it.
struct SampleAssignment {
    struct Move {
        std::uint32_t sample;
        int wedge;
    };
    std::vector<Move> moves;
    std::array<std::vector<float>, 3> position;             ///< of the moves' samples, by axis
    double sumOfSquares = 0;                                ///< of distances, mm2
    double largestSquare = 0;                               ///< of distances, mm2
    std::uint8_t leastClearance = SheetClearance::kAlone;   ///< of all samples, see Sample
    std::uint8_t clearanceUnseen = SheetClearance::kAlone;  ///< of triangles without samples
    /// The star comes so far towards other sheets that it could meet them.
    bool isCrowded = false;

    /// All samples, one or more, know of no other sheet near them.
    bool isInSingleSheet() const {
        return !moves.empty() && leastClearance == SheetClearance::kAlone;
    }
    void clear();
};

/// How far the samples of an unchanged star are from their triangles.
struct StarFit {
    double sumOfSquares = 0;   ///< mm2
    double largestSquare = 0;  ///< mm2
};

/// Which triangle of a patch each sample of the full-resolution surface is assigned to, and how far
/// off it is: the samples of the triangles that a change takes away are handed to the new ones.
class ErrorTracker {
public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    ErrorTracker(Patch& patch, const MetricFrame& frame);

    /// \return nothing when the star touches samples whose tolerance is smaller
    std::optional<StarFit> measure(const ChangedStar& unchanged) const;

    /// Finds for every sample of the star's triangles the near one of the changed triangles.
    /// \param result  what is found; its memory is used again
    /// \return VertexFar, RidgeFar or SampleFar when one would be farther than maxDistanceMm, or
    /// None
    Refusal assign(const ChangedStar& changed, double maxDistanceMm,
                   SampleAssignment& result) const;

    /// Hands the samples over as assign() found.
    void commit(const ChangedStar& changed, const SampleAssignment& assignment);

    /// The samples of a triangle, as a list.
    std::uint32_t first(std::uint32_t triangle) const { return firstSample_[triangle]; }
    std::uint32_t next(std::uint32_t sample) const { return nextSample_[sample]; }

private:
    template <class F>
    static void forEachTriangle(const Star& star, const F& f);
    void collect(const Star& star, SampleAssignment& result) const;
    bool vertexIsNear(const ChangedStar& changed, double maxDistanceMm,
                      SampleAssignment& result) const;
    bool samplesAreNear(const ChangedStar& changed, double most, SampleAssignment& result) const;
    SampleAssignment::Move nearest(const ChangedStar& changed, std::uint32_t sample, int start,
                                   double& squaredDistance) const;

    bool borderIsNear(const ChangedStar& changed, const SampleAssignment::Move& move,
                      double squaredLimit) const;
    const Sample& sampleNearest(const Vec3& p, const SampleAssignment& assignment) const;
    bool ridgesAreNear(const ChangedStar& changed, const SampleAssignment& assignment,
                       double maxDistanceMm) const;

    Patch& patch_;
    double sampleSpacingMm_;
    static constexpr int kClearances = SheetClearance::kAlone + 1;
    /// That may be used, mm2, by Sample::clearance.
    std::array<double, kClearances> squaredClearance_{};
    std::vector<std::uint32_t> firstSample_, nextSample_;
    std::vector<std::uint8_t> triangleClearance_;  ///< where there are no samples, see Sample
};

}  // namespace adaptiso::detail
