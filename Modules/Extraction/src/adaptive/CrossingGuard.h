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
/// comes near them; so most stars need no proof at all (see needsProof). Triangles that share a
/// vertex of the ring are proved together, by their common view (see fanIsClear); planes between
/// two triangles are tried for the others.
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

    /// The star was changed.
    void commit(const ChangedStar& changed);

private:
    /// Single precision, rounded outwards.
    struct Box {
        std::array<float, 3> low, high;
        bool overlaps(const Box& o) const {
            return low[0] <= o.high[0] && o.low[0] <= high[0] && low[1] <= o.high[1] &&
                   o.low[1] <= high[1] && low[2] <= o.high[2] && o.low[2] <= high[2];
        }
    };
    static Box rounded(const CornerBox& box);

    /// Samples by cubes of the lattice.
    struct Grid {
        Index3 low{}, count{1, 1, 1};
        std::vector<std::uint32_t> begin, samples;
    };
    void buildGrid();
    const Box& boxAt(std::uint32_t triangle);
    Corners cornersOf(std::uint32_t triangle) const;
    bool wedgesAreClear(const ChangedStar& changed) const;
    bool fanIsClear(const ChangedStar& changed, int at) const;
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
    std::vector<Box> box_;              ///< of each triangle, where it is known
    std::vector<std::uint8_t> hasBox_;  ///< it is known
    Box starBox_{};
    std::array<std::array<float, Star::kMost>, 3> wedgeLow_{}, wedgeHigh_{};  ///< by axis
    std::array<bool, Star::kMost> fanIsClear_{};  ///< of each vertex of the ring
};

}  // namespace adaptiso::detail
