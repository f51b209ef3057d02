#pragma once

#include <vector>

#include "FinishBoundaries.h"
#include "ImageSteps.h"

namespace adaptiso::headmodel {

/// Result of the search for the skull in a T1.
struct SkullBand {
    std::vector<float> outerSkull;  ///< raw part of voxels inside the outer skull
    std::vector<Vec3> seenMm;       ///< where rays show the outer skull
    double seenFraction = 0;        ///< of the rays towards the scalp, those that show the band
    /// The part of these rays that begins in 4 mm as bright as half of the brain's level: brain was
    /// lost there, or the inner skull lies in muscle.
    double tissueFraction = 0;
    /// The same of the inner skull's upper three fifths, without orbits, temporal poles and base.
    double upperTissueFraction = 0;
    double medianThicknessMm = 0;  ///< over the rays that do
    /// The largest connected part of the inner skull's upper three fifths whose rays to the scalp
    /// mostly show no band: its area, and the middle.
    double unseenMm2 = 0;
    Vec3 unseenMm;
};

/// The grey levels that rule the search.
struct HeadLevels {
    double air = 0;     ///< mean of the air around the head
    double tissue = 0;  ///< median of the brain
};

/// The outer skull of a T1: along the outward normal of the inner skull's surface the image is
/// dark in CSF and bone and bright again in the scalp. The outer skull is where, coming from the
/// scalp, the image falls halfway from the scalp (at most the brain's level: fat is brighter still)
/// to the darkest value of the bone. Fatty marrow between the tables does not matter, since the
/// search comes from outside.
///
/// Rays start at every voxel of the inner skull's surface. Those that do not reach the skin within
/// maxSkullMm + 15 mm (face, neck), or do not show a band at least half as dark as the brain is
/// bright and minSkullMm to maxSkullMm away, are not seen. Thickness is averaged over the surface
/// by normalized convolution [Knutsson1993] with a Gaussian of 6 mm, a second time without what
/// differs by more than 3 mm from the first; where nothing is seen nearby it tends to skullMm.
/// \param faces  as imageFaces(): 0 beyond the image
SkullBand findSkullBand(const std::vector<float>& t1, const ImageGeometry& grid,
                        std::vector<float> innerSkull, const Mask& skin,
                        const std::vector<std::uint8_t>& faces, const HeadLevels& levels,
                        const BoundaryOptions& options);

}  // namespace adaptiso::headmodel
