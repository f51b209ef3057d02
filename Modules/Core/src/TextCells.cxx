#include "adaptiso/Core/TextCells.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace {

using namespace std::string_view_literals;

/// Begins as a formula does, also behind quotes and apostrophes, which spreadsheets take away.
bool isFormula(std::string_view text) {
    const std::size_t first = text.find_first_not_of("\"' ");
    if (first == std::string_view::npos) return false;
    text.remove_prefix(first);
    constexpr std::string_view kSigns[] = {"=",
                                           "+",
                                           "-",
                                           "@",  // and, full-width, the same
                                           "\xEF\xBC\x9D",
                                           "\xEF\xBC\x8B",
                                           "\xEF\xBC\x8D",
                                           "\xEF\xBC\xA0"};
    return std::ranges::any_of(kSigns,
                               [&](std::string_view sign) { return text.starts_with(sign); });
}

bool needsMark(std::string_view text) {
    return isFormula(text) && !parseFiniteNumber(text);
}

template <class T>
bool spells(std::string_view word, T& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && stop == word.data() + word.size();
}

}  // namespace

char separatorOf(std::string_view line) {
    for (const char separator : {'\t', ';', ','}) {
        if (line.find(separator) != std::string_view::npos) return separator;
    }
    return '\0';
}

std::optional<std::vector<std::string>> cellsOf(std::string_view line, char separator) {
    std::vector<std::string> cells(1);
    bool isQuoted = false;
    for (std::size_t n = 0; n < line.size(); ++n) {
        const char c = line[n];
        if (separator != '\t' && c == '"') {
            const bool isDoubled = isQuoted && line.substr(n + 1).starts_with('"');
            if (isDoubled) {
                cells.back() += '"';
                ++n;
            } else {
                isQuoted = !isQuoted;
            }
        } else if (c == separator && !isQuoted) {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    if (isQuoted) return std::nullopt;
    for (std::string& cell : cells) {
        std::string_view text = trimmed(cell);
        const bool isWhole = separator == '\t' && text.size() > 1 && text.front() == '"' &&
                             text.find('"', 1) == text.size() - 1;
        if (isWhole) text = trimmed(text.substr(1, text.size() - 2));
        if (text.starts_with('\'') && needsMark(text.substr(1))) text.remove_prefix(1);
        cell = std::string(text);
    }
    return cells;
}

bool isMissing(std::string_view cell) {
    const std::string text = lowerCase(trimmed(cell));
    constexpr std::string_view kWords[] = {"",     "n/a",  "na",   "nan", "-nan",
                                           "+nan", "#n/a", "null", "none"};
    if (std::ranges::find(kWords, text) != std::end(kWords)) return true;
    const std::optional<double> value = parseReal(text);
    return value && std::isnan(*value);
}

std::optional<double> parseReal(std::string_view word) {
    double value = 0;
    if (spells(word, value)) return value;
    if (word.find('#') != std::string_view::npos) {
        if (word.find("1.#") > 1) return std::nullopt;
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        const std::string text = lowerCase(word);
        return text.find("#inf") == std::string::npos ? std::nan("")
               : word.starts_with('-')                ? -kInfinity
                                                      : kInfinity;
    }
    std::string text(word);
    const std::size_t exponent = text.find_first_of("dD");
    if (exponent == std::string::npos) return std::nullopt;
    text[exponent] = 'e';
    return spells(text, value) ? std::optional(value) : std::nullopt;
}

std::optional<double> cellNumber(std::string_view cell, char separator) {
    if (isMissing(cell)) return std::nan("");
    std::string text(trimmed(cell));
    const std::size_t comma = text.find(',');
    const bool isDecimal = separator != ',' && comma != std::string::npos &&
                           text.find_first_of(",.", comma + 1) == std::string::npos &&
                           text.find('.') == std::string::npos;
    if (isDecimal) text[comma] = '.';
    return parseReal(text);
}

std::string writtenCell(std::string_view text) {
    const std::string cell = withoutControls(text);
    if (trimmed(cell).empty()) return "n/a";
    return needsMark(cell) ? "'" + cell : cell;
}

}  // namespace adaptiso
