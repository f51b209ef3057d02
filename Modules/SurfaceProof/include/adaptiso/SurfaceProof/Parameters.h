#pragma once

/// Constants of SurfaceWalk and PieceBound that were chosen, with their units and reasons.
namespace adaptiso::detail {

/// Cuts of a piece, one after the other: to try, and to be sure; halvings that find where to cut.
inline constexpr int kFewCuts = 3, kManyCuts = 8, kCutHalvings = 10;
/// A bound that must grow grows by 1 % more (of the distance, here squared), so that it need not
/// grow often.
inline constexpr double kBoundGrowth = 1.0201;

}  // namespace adaptiso::detail
