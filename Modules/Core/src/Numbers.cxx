#include "adaptiso/Core/Numbers.h"

#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

constexpr double kMostInFull = 1e15;  // longer numbers are no help to a reader

}  // namespace

std::optional<double> parseFiniteNumber(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || last != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::string formatNumber(double value) {
    if (value == 0) return "0";
    const double size = std::abs(value);
    const auto format =
        size >= 1e-6 && size < kMostInFull ? std::chars_format::fixed : std::chars_format::general;
    std::array<char, 64> text;
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, format);
    return {text.data(), end};
}

std::string formatShort(double value) {
    return shortText(value);
}

std::string formatCount(long long value) {
    std::string text = std::to_string(value);
    const std::size_t firstDigit = value < 0 ? 1 : 0;
    for (std::size_t at = text.size(); at > firstDigit + 3;) text.insert(at -= 3, 1, ',');
    return text;
}

std::string formatRounded(double value) {
    if (!(std::abs(value) < kMostInFull)) return formatShort(value);
    return formatCount(std::llround(value));
}

std::string formatFixed(double value, int digits) {
    if (!(std::abs(value) < kMostInFull)) return formatShort(value);
    std::ostringstream text;
    text << std::fixed << std::setprecision(digits) << value;
    const std::string shown = text.str();
    const bool isMinusZero =
        shown[0] == '-' && shown.find_first_of("123456789") == std::string::npos;
    return isMinusZero ? shown.substr(1) : shown;
}

}  // namespace adaptiso
