#include "adaptiso/Core/Text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

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

}  // namespace adaptiso
