#pragma once

#include <string_view>

namespace adaptiso::openmeeg {

// The first lines, exact.
inline constexpr std::string_view kGeometryHeader = "# Domain Description 1.1";
inline constexpr std::string_view kConductivityHeader =
    "# Properties Description 1.0 (Conductivities)";

}  // namespace adaptiso::openmeeg
