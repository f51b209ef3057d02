#include "adaptiso/Core/Text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace adaptiso {

std::string shortText(double value) {
    if (std::isnan(value)) return "not a number";
    if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
    if (value == 0) return "0";
    constexpr int kDigits = 6;
    std::array<char, 32> text;
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                            std::chars_format::general, kDigits);
    return {text.data(), end};
}

}  // namespace adaptiso
