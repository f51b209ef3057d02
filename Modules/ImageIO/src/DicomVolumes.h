#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "DicomPlanes.h"

namespace adaptiso::detail {

/// The planes' indices, by place along their normal: those at one place (1e-3 mm) together.
/// \pre  all planes have a position and one common orientation
std::vector<std::vector<std::size_t>> dicomPlaces(const std::vector<DicomPlane>& planes);

struct DicomVolumes {
    /// One plane a place each; ordered by what tells them apart. None: the planes repeat in no
    /// order that a header explains.
    std::vector<std::vector<DicomPlane>> volumes;
    std::string_view kind;  ///< "echoes", "time points", ...; empty for a single volume
};

/// Tells the volumes of a 4-D series apart where several planes lie at every place: by the one
/// attribute that does, by all of them, by times of acquisition, or by the images' numbers where
/// these are those of whole passes. None where two of these tell them apart differently.
/// \pre  as dicomPlaces
DicomVolumes splitDicomVolumes(const std::vector<DicomPlane>& planes);

}  // namespace adaptiso::detail
