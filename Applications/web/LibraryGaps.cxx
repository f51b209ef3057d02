#include "LibraryGaps.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

/// fmt finds the digits; their layout is the standard's, that of printf.
namespace std {
namespace {

to_chars_result copied(char* first, char* last, const char* text, size_t size) {
    if (static_cast<size_t>(last - first) < size) return {last, errc::value_too_large};
    return {std::copy_n(text, size, first), errc{}};
}

template <class T>
to_chars_result printed(char* first, char* last, T value, chars_format format, int precision) {
    fmt::memory_buffer text;
    const auto to = std::back_inserter(text);
    if (format == chars_format::fixed) {
        fmt::format_to(to, "{:.{}f}", value, precision);
    } else if (format == chars_format::scientific) {
        fmt::format_to(to, "{:.{}e}", value, precision);
    } else {
        fmt::format_to(to, "{:.{}g}", value, precision);
    }
    return copied(first, last, text.data(), text.size());
}

/// The shortest digits that read back as `value`; fixed or scientific, whichever is shorter.
template <class T>
to_chars_result shortest(char* first, char* last, T value, bool mayBeFixed = true,
                         bool mayBeScientific = true) {
    if (!std::isfinite(value)) {
        const char* const text = std::isnan(value) ? (std::signbit(value) ? "-nan" : "nan")
                                                   : (value < 0 ? "-inf" : "inf");
        return copied(first, last, text, strlen(text));
    }
    const bool isNegative = std::signbit(value);
    const string general = fmt::format("{}", std::abs(value));  // shortest, in either notation
    const string mantissa = general.substr(0, general.find('e'));
    int exponent = static_cast<int>(std::min(mantissa.find('.'), mantissa.size())) - 1;
    if (mantissa.size() < general.size()) exponent += std::atoi(&general[mantissa.size() + 1]);
    string digits;
    for (const char c : mantissa) {
        if (c == '.') continue;
        if (c == '0' && digits.empty() && value != 0) {
            --exponent;
        } else {
            digits += c;
        }
    }
    digits.resize(std::max<size_t>(digits.find_last_not_of('0') + 1, 1));
    string scientific = (isNegative ? "-" : "") + digits;
    if (digits.size() > 1) scientific.insert(isNegative ? 2 : 1, ".");
    scientific += fmt::format("e{}{:02}", exponent < 0 ? '-' : '+', std::abs(exponent));
    if (!mayBeFixed) return copied(first, last, scientific.data(), scientific.size());
    const int count = static_cast<int>(digits.size());
    string fixed = isNegative ? "-" : "";
    if (exponent < 0) {
        fixed += "0." + string(static_cast<size_t>(-exponent - 1), '0') + digits;
    } else if (exponent >= count - 1) {
        // all digits of a large integer are exact, as the standard's libraries have them
        fixed = fmt::format("{:.0f}", value);
    } else {
        fixed += digits.substr(0, exponent + 1) + "." + digits.substr(exponent + 1);
    }
    const bool isFixed = !mayBeScientific || fixed.size() <= scientific.size();
    const string& text = isFixed ? fixed : scientific;
    return copied(first, last, text.data(), text.size());
}

template <class T>
from_chars_result read(const char* first, const char* last, T& value) {
    // a number's own characters alone, so that no sign "+", blank or hexadecimal is taken
    const char* next = first;
    string text;
    if (next != last && *next == '-') text += *next++;
    const bool isNumber = next != last && ((*next >= '0' && *next <= '9') || *next == '.');
    const bool isWord = next != last && strchr("iInN", *next) != nullptr;
    if (!isNumber && !isWord) return {first, errc::invalid_argument};
    for (; next != last && text.size() < 1200; ++next) {
        const bool isTaken = isNumber ? strchr("0123456789.eE+-", *next) != nullptr && *next != '\0'
                                      : strchr("infatyINFATY", *next) != nullptr && *next != '\0';
        if (!isTaken) break;
        text += *next;
    }
    char* end = nullptr;
    errno = 0;
    T found;
    if constexpr (is_same_v<T, float>) {
        found = strtof(text.c_str(), &end);
    } else {
        found = strtod(text.c_str(), &end);
    }
    const auto size = end - text.c_str();
    if (size == 0) return {first, errc::invalid_argument};
    const bool isOutside = isNumber && errno == ERANGE && (found == 0 || std::isinf(found));
    if (isOutside) return {first + size, errc::result_out_of_range};
    value = found;
    return {first + size, errc{}};
}

}  // namespace

to_chars_result to_chars(char* first, char* last, double value) {
    return shortest(first, last, value);
}
to_chars_result to_chars(char* first, char* last, float value) {
    return shortest(first, last, value);
}
to_chars_result to_chars(char* first, char* last, double value, chars_format format) {
    return shortest(first, last, value, format != chars_format::scientific,
                    format != chars_format::fixed);
}
to_chars_result to_chars(char* first, char* last, double value, chars_format format,
                         int precision) {
    return printed(first, last, value, format, precision);
}
to_chars_result to_chars(char* first, char* last, float value, chars_format format, int precision) {
    return printed(first, last, static_cast<double>(value), format, precision);
}
from_chars_result from_chars(const char* first, const char* last, double& value) {
    return read(first, last, value);
}
from_chars_result from_chars(const char* first, const char* last, float& value) {
    return read(first, last, value);
}

}  // namespace std

// Functions that Emscripten's C library declares and lacks: files are in memory, without children.
extern "C" {
int syncfs(int) {
    return 0;
}
int prctl(int, ...) {
    errno = ENOSYS;
    return -1;
}
}
