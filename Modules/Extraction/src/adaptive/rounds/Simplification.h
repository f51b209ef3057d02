#pragma once

#include <cstdint>
#include <optional>

#include "adaptive/full/FullSurface.h"
#include "adaptive/rounds/PatchRound.h"

namespace adaptiso::detail {

/// How many triangles are wanted: a number, or a share of those of the full surface to drop.
struct WantedCount {
    std::optional<std::int64_t> triangles;
    std::optional<double> reduction;
    std::int64_t fewer = 0;  ///< by so many than that

    bool isGiven() const { return triangles || reduction; }
    std::int64_t of(std::int64_t fineTriangles) const {
        std::int64_t count = std::min(triangles.value_or(fineTriangles), fineTriangles);
        if (reduction) {
            const double kept = (1 - *reduction) * static_cast<double>(fineTriangles);
            count = std::min(count, static_cast<std::int64_t>(kept));
        }
        return std::max<std::int64_t>(count - fewer, 0);
    }
};

/// One run of the simplification with fixed limits, in rounds: first every brick alone, then the
/// patches of shifted cuts in turn, with a limit of cost that grows, so that all parts of the
/// surface get coarser together.
class Simplification {
public:
    Simplification(const FullSurface& full, const PatchLimits& limits);

    /// As few triangles as the limits allow.
    SimplifiedSurface toLimits();

    /// The wanted number of triangles, or as few as the limits allow.
    /// \param farthestMm  where they don't, the allowed distance of samples is doubled on the way
    ///                    until it is as large as that. Where that does not lead to the count, the
    ///                    surface is the one after the last doubling that dropped a tenth of the
    ///                    triangles (kWorthDoubling)
    SimplifiedSurface toCount(const WantedCount& wanted, double farthestMm);

private:
    void fit(SimplifiedSurface& surface);
    PatchCut nextCut(const SimplifiedSurface& surface);
    void roundUpTo(double cost, SimplifiedSurface& surface, bool fits = false);
    SimplifiedSurface beginGently();
    void approach(SimplifiedSurface& surface, std::int64_t target, double farthestMm);
    void goFarther(SimplifiedSurface& surface);
    void beginAnew(SimplifiedSurface& surface);
    void roundTowards(SimplifiedSurface& surface, std::int64_t target, double cost);

    const FullSurface& full_;
    const MetricFrame& frame_;
    PatchLimits limits_;
    double costUnit_;
    int rounds_ = 0;
    std::optional<int> doublings_;  ///< of the cubes' sides
    int fits_ = 0;                  ///< how many of the last rounds were with fits
    std::int64_t collapsed_ = 0;    ///< in the last round
    bool isTied_ = false;           ///< the last round made less than half of its collapses
};

}  // namespace adaptiso::detail
