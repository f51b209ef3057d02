#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

namespace adaptiso {

/// The test "sample >= isovalue" in the samples' own type, exact for every type and isovalue.
///
/// For integers the isovalue is rounded up, for floats to the next one not below it, so that one
/// comparison of native values decides, without converting samples.
template <class T>
struct IsovalueTest {
    enum class Kind {
        Some,  ///< compare with `threshold`
        All,   ///< every value of the type reaches the isovalue
        None   ///< no value of the type does
    };
    Kind kind = Kind::Some;
    T threshold{};

    /// \pre isovalue is finite
    explicit IsovalueTest(double isovalue) {
        if constexpr (std::is_floating_point_v<T>) {
            threshold = static_cast<T>(isovalue);
            if (static_cast<double>(threshold) < isovalue) {
                threshold = std::nextafter(threshold, std::numeric_limits<T>::infinity());
            }
        } else {
            // 2^digits is exact in double, max() of a 64-bit type is not
            const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
            const double rounded = std::ceil(isovalue);
            if (rounded >= end) {
                kind = Kind::None;
                threshold = std::numeric_limits<T>::max();
            } else if (rounded <= static_cast<double>(std::numeric_limits<T>::lowest())) {
                kind = Kind::All;
                threshold = std::numeric_limits<T>::lowest();
            } else {
                threshold = static_cast<T>(rounded);
            }
        }
    }

    /// NaN is outside. Kind::None needs no case of its own where the caller has asked before.
    bool operator()(T value) const { return kind != Kind::None && value >= threshold; }
};

}  // namespace adaptiso
