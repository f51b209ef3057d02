#pragma once

#include <optional>
#include <string_view>

namespace adaptiso {

/// A value measured of a head, and the limits outside of which it is noted or warned of.
struct HeadFigure {
    std::string_view key;  ///< "dentMm"
    double value = 0;
    std::optional<double> least{}, most{};
};

}  // namespace adaptiso
