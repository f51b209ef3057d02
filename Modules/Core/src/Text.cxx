#include "adaptiso/Core/Text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <sstream>

namespace adaptiso {

std::string formatShort(double value) {
    if (std::isnan(value)) return "not a number";
    if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
    if (value == 0) return "0";
    constexpr int kDigits = 6;
    std::array<char, 32> text;
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                            std::chars_format::general, kDigits);
    return {text.data(), end};
}

std::string lowerCase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return lower;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r\n\v\f";
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string visibleAscii(std::string_view text) {
    std::string visible(text);
    for (char& c : visible) {
        if (c < ' ' || c > '~') c = '?';
    }
    return visible;
}

std::string printable(std::string_view text) {
    constexpr std::size_t kMost = 40;
    return "'" + visibleAscii(text.substr(0, kMost)) + (text.size() > kMost ? "...'" : "'");
}

namespace {

/// Bytes of the UTF-8 character at `at`; 1 for a byte that begins none.
std::size_t characterBytes(std::string_view text, std::size_t at) {
    const auto c = static_cast<unsigned char>(text[at]);
    const std::size_t bytes = c >= 0xf0 ? 4 : c >= 0xe0 ? 3 : c >= 0xc2 ? 2 : 1;
    for (std::size_t n = 1; n < bytes; ++n) {
        if (at + n == text.size() || (static_cast<unsigned char>(text[at + n]) & 0xc0) != 0x80) {
            return 1;
        }
    }
    return bytes;
}

/// Of a whole character, or of a byte that is none: as some terminals take Latin-1's.
bool isControl(std::string_view character) {
    const auto c = static_cast<unsigned char>(character[0]);
    if (character.size() == 1) return c < 0x20 || (c >= 0x7f && c < 0xa0);
    if (character.size() == 2) {
        return (c == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0) ||
               character == "\u061c";
    }
    const bool isTag = character >= "\U000E0000" && character <= "\U000E007F";
    if (character.size() == 4) return isTag;
    const bool isMark = character == "\u200e" || character == "\u200f" || character == "\ufeff";
    const bool isLineOrEmbedding = character >= "\u2028" && character <= "\u202e";
    const bool isIsolate = character >= "\u2066" && character <= "\u2069";
    return isMark || isLineOrEmbedding || isIsolate;
}

}  // namespace

std::string withoutControls(std::string_view text, std::string_view kept) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t at = 0, bytes = 0; at < text.size(); at += bytes) {
        bytes = characterBytes(text, at);
        const std::string_view character = text.substr(at, bytes);
        const bool isKept = bytes == 1 && kept.find(character[0]) != std::string_view::npos;
        if (isKept || !isControl(character)) {
            result += character;
        } else {
            result += ' ';
        }
    }
    return result;
}

std::string escapedMarkup(std::string_view text) {
    std::string result;
    for (const char c : withoutControls(text)) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string encodeBase64(std::string_view bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const char byte = i + k < bytes.size() ? bytes[i + k] : '\0';
            group = group << 8 | static_cast<unsigned char>(byte);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool isPadding = i + k > bytes.size();
            text += isPadding ? '=' : kDigits[group >> (18 - 6 * k) & 63];
        }
    }
    return text;
}

bool isUtf8(std::string_view text) {
    for (std::size_t n = 0; n < text.size();) {
        const auto c = static_cast<unsigned char>(text[n++]);
        if (c < 0x80) continue;
        const int more = c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : 1;
        if (c < 0xc2 || c > 0xf4) return false;
        for (int k = 0; k < more; ++k, ++n) {
            if (n == text.size() || (static_cast<unsigned char>(text[n]) & 0xc0) != 0x80) {
                return false;
            }
        }
        // too long a form, half of a pair, or beyond the last character
        const auto second = static_cast<unsigned char>(text[n - static_cast<std::size_t>(more)]);
        if ((c == 0xe0 && second < 0xa0) || (c == 0xed && second > 0x9f) ||
            (c == 0xf0 && second < 0x90) || (c == 0xf4 && second > 0x8f)) {
            return false;
        }
    }
    return true;
}

std::string toUtf8(std::string_view text) {
    if (isUtf8(text)) return std::string(text);
    std::string result;
    for (const char each : text) {
        const auto c = static_cast<unsigned char>(each);
        if (c < 0x80) {
            result += each;
        } else {
            result += static_cast<char>(0xc0 | c >> 6);
            result += static_cast<char>(0x80 | (c & 0x3f));
        }
    }
    return result;
}

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
    constexpr double kNoise = 1e-9;  // of sums of doubles
    const auto isLess = [&](const std::string& text) {
        return parseFiniteNumber(text).value_or(value) < (1 - kNoise) * value;
    };
    std::string text = formatLength(value, digits);
    if (!isLess(text)) return text;
    text = formatLength(value, ++digits);
    if (!isLess(text)) return text;
    const double last = isLargeFor(digits, value)
                            ? std::pow(10, -digits)
                            : std::pow(10, std::floor(std::log10(value)) - kLeastDigits + 1);
    // rounded to the nearest it is less by half of the last digit at most
    return formatLength(value + 0.6 * last, digits);
}

std::string formatSizeMm(const Vec3& mm) {
    const auto text = [](double value) {
        return value < 0.1 ? formatLength(value, 4)
                           : formatNumber(std::stod(formatFixed(value, value < 1 ? 4 : 1)));
    };
    return text(mm.x) + " x " + text(mm.y) + " x " + text(mm.z) + " mm";
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
