#pragma once

#include <cstddef>

#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// Conductivities of a head model's compartments, S/m. The defaults are MNE's (0.3, 0.006, 0.3
/// in mne.make_bem_model; skull to brain 1 : 50). Published ratios lie between 1 : 15 and 1 : 80;
/// 0.33, 0.0041, 0.33 (1 : 80) is the classic choice [Rush1969].
struct ConductivityModel {
    double brain = 0.3;  ///< of three layers: all within the inner skull, CSF included
    double skull = 0.006;
    double scalp = 0.3;
    double csf = 1.79;  ///< of four layers [Baumann1997]

    /// Conductivity within `surface` and outside the next one, in a model of `count` surfaces.
    double within(HeadSurface surface, std::size_t count) const;
};

/// \throws InvalidInput  a conductivity that is not finite, 0 or less, or above 10 S/m (sea water
///                       has 5; S/cm or mS/m were meant)
void checkConductivities(const ConductivityModel& model);

}  // namespace adaptiso
