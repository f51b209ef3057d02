#pragma once

#include <cstdint>
#include <vector>

#include "../Certificate.h"
#include "ChangedStar.h"
#include "MetricFrame.h"
#include "PatchTopology.h"

namespace adaptiso::detail {

/// Proves that a changed star crosses no triangle near it. What can't be proved is refused.
///
/// Near triangles are found by the samples around the star: each names the triangle that stands
/// for it. Samples that lie in a single sheet are left out, since no other part of the surface
/// comes near them; so most stars need no proof at all (see needsProof).
class CrossingGuard {
public:
    /// \param looksEverywhere  all samples are looked at, and every star is proved
    CrossingGuard(const Patch& patch, const PatchTopology& topology, const MetricFrame& frame,
                  bool looksEverywhere);

    /// A star that is a graph over a plane, in a single sheet, can cross nothing.
    bool needsProof(const ChangedStar& changed, bool isCrowded) const {
        return looksEverywhere_ || isCrowded || !changed.isGraph;
    }

    bool crossesNothing(const ChangedStar& changed);

private:
    /// Samples by cubes of the lattice.
    struct Grid {
        Index3 low{}, count{1, 1, 1};
        std::vector<std::uint32_t> begin, samples;
    };
    void buildGrid();
    Corners cornersOf(std::uint32_t triangle) const;
    bool wedgesAreClear(const ChangedStar& changed) const;
    bool isClear(const ChangedStar& changed, int wedge, std::uint32_t other) const;
    void collectNear(const ChangedStar& changed);
    void collectAroundRing(const Star& star);
    void collectFromGrid(const ChangedStar& changed);
    void addNear(std::uint32_t triangle);

    const Patch& patch_;
    const PatchTopology& topology_;
    const MetricFrame& frame_;
    bool looksEverywhere_;
    double gapMm_;
    Grid grid_;
    std::vector<std::uint32_t> stamp_;  ///< of triangles seen in this search
    std::uint32_t now_ = 0;
    std::vector<std::uint32_t> near_;
    CornerBox starBox_;
    std::array<CornerBox, Star::kMost> wedgeBox_;
};

}  // namespace adaptiso::detail
