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
constexpr int kLeastDigits = 3;       // significant

std::string formatGeneral(double value, int digits) {
    std::array<char, 64> text;
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                            std::chars_format::general, digits);
    return {text.data(), end};
}

/// `digits` decimals leave kLeastDigits, or the value has none.
bool isLargeFor(int digits, double value) {
    return value == 0 || !(std::abs(value) < std::pow(10, kLeastDigits - 1 - digits));
}

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

std::string formatLength(double value, int digits) {
    constexpr double kNothing = 1e-9;  // mm: rounding of doubles
    std::string fixed = formatFixed(value, digits);
    if (isLargeFor(digits, value) || std::abs(value) < kNothing) return fixed;
    std::string significant = formatGeneral(value, kLeastDigits);
    return parseFiniteNumber(fixed) == parseFiniteNumber(significant) ? fixed : significant;
}

std::string formatBound(double value, int digits) {
    std::string text = formatLength(value, digits);
    const double last = isLargeFor(digits, value)
                            ? std::pow(10, -digits)
                            : std::pow(10, std::floor(std::log10(value)) - kLeastDigits + 1);
    constexpr double kNoise = 1e-9;  // of sums of doubles
    // rounded to the nearest it is less by half of the last digit at most
    if (parseFiniteNumber(text).value_or(value) < (1 - kNoise) * value) {
        text = formatLength(value + 0.6 * last, digits);
    }
    return text;
}

std::string formatMeasure(double value) {
    return isLargeFor(0, value) ? formatRounded(value) : formatGeneral(value, kLeastDigits);
}

std::vector<std::string> formatApart(const std::vector<double>& values) {
    constexpr int kMostDigits = 17;  // tell all doubles apart
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(formatShort(value));
    const auto areApart = [&] {
        for (std::size_t a = 0; a < values.size(); ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                if (texts[a] == texts[b] && values[a] != values[b]) return false;
            }
        }
        return true;
    };
    for (int digits = 7; digits <= kMostDigits && !areApart(); ++digits) {
        for (std::size_t n = 0; n < values.size(); ++n) {
            if (std::isfinite(values[n])) texts[n] = formatGeneral(values[n], digits);
        }
    }
    return texts;
}

}  // namespace adaptiso
