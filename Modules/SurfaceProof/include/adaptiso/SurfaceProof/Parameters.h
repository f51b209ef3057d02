#pragma once

/// Constants of SurfaceWalk and PieceBound that were chosen, with their units and reasons.
namespace adaptiso::detail {

/// Quartered parts whose longest side is less than this many times the bound are cut along the
/// walk; those above that many times are quartered again without a look at what they lie over.
inline constexpr double kSmallQuarter = 2, kLargeQuarter = 6;
/// Steps towards the triangle under a point.
inline constexpr int kStepsUnder = 16;
/// Cuts of a piece, one after the other: to try, and to be sure; halvings that find where to cut.
inline constexpr int kFewCuts = 3, kManyCuts = 8, kCutHalvings = 10;
/// A bound that must grow grows by 1 % more (of the distance, here squared), so that it need not
/// grow often.
inline constexpr double kBoundGrowth = 1.0201;

}  // namespace adaptiso::detail
