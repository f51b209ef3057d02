#pragma once

#include <string>

namespace adaptiso {

/// `value` as a person reads it, in at most six significant digits, in the C locale: "0.333333",
/// "1.79769e+308", "infinity", "-infinity", "not a number". Zero is "0", whatever its sign.
std::string shortText(double value);

}  // namespace adaptiso
