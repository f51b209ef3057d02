#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "FinishBoundaries.h"
#include "ImageSteps.h"

namespace adaptiso::headmodel {

/// How long a part that the ball can't enter must be, along its own way, to be a neck and not a
/// corner: longer than the bumps of an inner skull (sella, olfactory groove), shorter than a leak
/// through a foramen that matters.
inline constexpr double kNeckReachMm = 10;

/// A part of a solid that a ball can't enter and that reaches far: what leaks down a foramen.
struct Neck {
    double reachMm = 0;  ///< from where the ball stops to the farthest end, within the solid
    double mm3 = 0;
    Vec3 tipMm;                        ///< the farthest end
    std::vector<std::int64_t> voxels;  ///< but for a stub of kNeckStubMm, which stays
};
inline constexpr double kNeckStubMm = 2;

/// The necks of a solid by an opening test [Serra1982]: what an opening by a ball takes away, and
/// of that what lies farther than kNeckReachMm from what is left, measured within the solid. The
/// solid is closed by `closingMm` before, so that gyri between open sulci are none.
/// Longest first.
/// Cost: some distance maps, O(voxels) each, and O(n log n) for the n voxels that the opening
/// takes.
std::vector<Neck> findNecks(const Mask& solid, const ImageGeometry& grid, double ballMm,
                            double closingMm);

/// Cuts the necks of the inner skull (raw.parts[0]) as options.cutNecksMm says, and notes each with
/// its place. What was cut stays in the outer skull (raw.parts[1], if there) where bone is round
/// it, as in a canal that the ball doesn't fit into, and goes elsewhere.
void cutNecks(RawBoundaries& raw, const BoundaryOptions& options);

}  // namespace adaptiso::headmodel
