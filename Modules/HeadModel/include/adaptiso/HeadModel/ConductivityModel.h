#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// S/m, as SimNIBS has it [Opitz2015].
inline constexpr double kSpongyBoneConductivity = 0.025;

/// Conductivities of a head model's compartments, S/m. The defaults are MNE's (0.3, 0.006, 0.3
/// in mne.make_bem_model; skull to brain 1 : 50). Published ratios lie between 1 : 15 and 1 : 80;
/// 0.33, 0.0041, 0.33 (1 : 80) is the classic choice [Rush1969].
struct ConductivityModel {
    double brain =
        0.3;  ///< of three layers: all within the inner skull, CSF included; of five grey
    double skull = 0.006;
    double scalp = 0.3;
    double csf = 1.79;     ///< of four layers [Baumann1997]
    double white = 0.126;  ///< of five [Wagner2004]

    /// Conductivity within `surface` and outside the next one, in a model of `count` surfaces.
    double within(HeadSurface surface, std::size_t count) const;
};

/// The defaults of a model of `count` surfaces: of five those of SimNIBS and BEM-FMM (0.126, 0.275,
/// 1.654, 0.01, 0.465) [Wagner2004], else as above.
ConductivityModel standardConductivities(std::size_t count);

/// What lies within a surface and outside of the next one.
struct HeadTissue {
    std::string_view name;    ///< in reports, and FieldTrip's
    std::string_view domain;  ///< OpenMEEG's, BEM-FMM's
    std::int32_t number;      ///< SimNIBS's
    double ConductivityModel::*conductivity;
};

/// The tissue within `surface` and outside of the next one, in a model of `count` surfaces: all of
/// the brain where a model of fewer than five has no surface within.
const HeadTissue& tissueWithin(HeadSurface surface, std::size_t count);

/// \throws InvalidInput  a conductivity that is not finite, 0 or less, or above 10 S/m (sea water
///                       has 5; S/cm or mS/m were meant)
void checkConductivities(const ConductivityModel& model);

}  // namespace adaptiso
