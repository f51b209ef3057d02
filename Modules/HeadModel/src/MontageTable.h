#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace adaptiso::headmodel {

/// An electrode of a cap.
struct CapPlace {
    std::string name;
    std::string standardName;  ///< of the same place in the 10-05 system; empty: by the angles
    double polarDeg =
        0;  ///< from Cz: 92 on the ring through Fpz, T7 and Oz, 115 through nasion, ears, inion
    double azimuthDeg = 0;  ///< from the right ear to the nasion
};

/// The electrodes of a cap, in its own order. \pre one of montageNames() that is no system
std::vector<CapPlace> capPlaces(std::string_view montage);

}  // namespace adaptiso::headmodel
