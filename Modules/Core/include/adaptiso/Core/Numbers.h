#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace adaptiso {

/// The number that all of `text` is, in the C locale ("100", "-0.5", "+1e3"), whatever the user's.
/// \return none when it is no number, not finite, or too large for a double
std::optional<double> parseFiniteNumber(std::string_view text);

/// The shortest decimal text that reads back as `value`, without an exponent unless the number is
/// below 1e-6 or from 1e15 on: "100000", "0.1", "-200". Zero is "0", whatever its sign.
std::string formatNumber(double value);

/// `value` in at most six digits, as a person reads it; infinity and NaN in words (shortText()).
std::string formatShort(double value);

/// `value` with its digits in groups of three: "1,234,567".
std::string formatCount(long long value);

/// `value` to the nearest whole number, in groups of three; from 1e15 on, and for infinity and
/// NaN, as formatShort().
std::string formatRounded(double value);

/// `value` with `digits` decimals: "0.10", never "-0.00"; from 1e15 on, and for infinity and NaN,
/// as formatShort().
std::string formatFixed(double value, int digits);

}  // namespace adaptiso
