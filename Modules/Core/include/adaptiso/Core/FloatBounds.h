#pragma once

#include <cmath>
#include <limits>

namespace adaptiso {

/// A little below a number, in single precision; and a little above.
inline float floatBelow(double x) {
    const auto f = static_cast<float>(x);
    return f - (2 * std::numeric_limits<float>::epsilon() * std::abs(f) +
                std::numeric_limits<float>::min());
}
inline float floatAbove(double x) {
    const auto f = static_cast<float>(x);
    return f + (2 * std::numeric_limits<float>::epsilon() * std::abs(f) +
                std::numeric_limits<float>::min());
}

}  // namespace adaptiso
