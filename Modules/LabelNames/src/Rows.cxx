#include "Rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::labelnames {
namespace {

/// The names of CSS that tables use, as CSS and matplotlib define them.
constexpr std::pair<std::string_view, LabelColor> kColorNames[] = {
    {"black", {0, 0, 0}},       {"silver", {192, 192, 192}},   {"gray", {128, 128, 128}},
    {"grey", {128, 128, 128}},  {"white", {255, 255, 255}},    {"maroon", {128, 0, 0}},
    {"red", {255, 0, 0}},       {"purple", {128, 0, 128}},     {"fuchsia", {255, 0, 255}},
    {"green", {0, 128, 0}},     {"lime", {0, 255, 0}},         {"olive", {128, 128, 0}},
    {"yellow", {255, 255, 0}},  {"navy", {0, 0, 128}},         {"blue", {0, 0, 255}},
    {"teal", {0, 128, 128}},    {"aqua", {0, 255, 255}},       {"cyan", {0, 255, 255}},
    {"magenta", {255, 0, 255}}, {"orange", {255, 165, 0}},     {"pink", {255, 192, 203}},
    {"brown", {165, 42, 42}},   {"gold", {255, 215, 0}},       {"violet", {238, 130, 238}},
    {"indigo", {75, 0, 130}},   {"turquoise", {64, 224, 208}}, {"salmon", {250, 128, 114}},
    {"coral", {255, 127, 80}},  {"khaki", {240, 230, 140}},    {"tan", {210, 180, 140}}};

/// "255, 128, 0", opacity behind it or not.
std::optional<LabelColor> parseChannels(std::string_view text) {
    const auto cells = cellsOf(text, ',');
    if (!cells || cells->size() < 3 || cells->size() > 4) return std::nullopt;
    LabelColor color{};
    for (std::size_t n = 0; n < 3; ++n) {
        const std::optional<double> value = realNumber((*cells)[n]);
        if (!value || *value < 0 || *value > 255) return std::nullopt;
        color[n] = static_cast<std::uint8_t>(std::lround(*value));
    }
    return color;
}

}  // namespace

void damaged(const std::string& what) {
    throw FileError(what + "; the table is damaged: mend or replace it");
}

void refuseKind(const std::string& why) {
    throw NoLabelTable("is no table of labels that can be read (" + labelTableNames() +
                       "): " + why);
}

std::vector<Line> linesOf(std::string_view text) {
    std::vector<Line> lines;
    TextLines source(text);
    while (const auto line = source.next()) {
        const std::string_view words = trimmed(*line);
        if (!words.empty() && words.front() != '#') lines.push_back({source.number(), *line});
    }
    return lines;
}

bool endsText(const Line& line, std::string_view text) {
    return line.text.data() + line.text.size() == text.data() + text.size();
}

std::string place(const Line& line) {
    return linePlace(line.number);
}

std::optional<double> realNumber(std::string_view word) {
    const std::optional<double> value = parseReal(trimmed(word));
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> wholeNumber(std::string_view word) {
    const std::optional<double> value = realNumber(word);
    constexpr double kMost = 1e15;  // exact in double
    if (!value || *value != std::floor(*value) || std::abs(*value) > kMost) return std::nullopt;
    return static_cast<std::int64_t>(*value);
}

std::int64_t valueOf(std::string_view word, const Line& line, char separator) {
    const std::string_view digits = trimmed(word);
    std::int64_t whole = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), whole);
    if (error == std::errc() && end == digits.data() + digits.size()) return whole;
    const std::optional<double> value = cellNumber(word, separator);
    constexpr double kMost = std::int64_t{1} << 53;
    if (!value || *value != std::floor(*value) || !(std::abs(*value) <= kMost)) {
        damaged(place(line) + "the index is " + printable(word) +
                ", must be a whole number that 64 bits with a sign hold");
    }
    return static_cast<std::int64_t>(*value);
}

std::optional<LabelColor> parseColor(std::string_view text) {
    std::string word = lowerCase(trimmed(text));
    for (const auto& [name, color] : kColorNames) {
        if (word == name) return color;
    }
    if (const std::size_t open = word.find('('); open != std::string::npos) {
        const bool isRgb = word.starts_with("rgb") && word.ends_with(')');
        return isRgb ? parseChannels(word.substr(open + 1, word.size() - open - 2)) : std::nullopt;
    }
    const bool hasSign = word.starts_with('#');
    if (hasSign) word.erase(0, 1);
    if (hasSign && (word.size() == 3 || word.size() == 4)) {  // each digit stands for two
        std::string doubled;
        for (const char digit : word) doubled.append(2, digit);
        word = doubled;
    }
    if (word.size() != 6 && word.size() != 8) return std::nullopt;  // 8: with opacity
    LabelColor color{};
    for (std::size_t n = 0; n < word.size() / 2; ++n) {
        std::uint8_t channel = 0;
        const char* const begin = word.data() + 2 * n;
        const auto [last, error] = std::from_chars(begin, begin + 2, channel, 16);
        if (error != std::errc() || last != begin + 2) return std::nullopt;
        if (n < color.size()) color[n] = channel;
    }
    return color;
}

void Collector::add(LabelEntry entry) {
    entry.name = std::string(trimmed(withoutControls(entry.name)));
    entry.abbreviation = std::string(trimmed(withoutControls(entry.abbreviation)));
    constexpr std::size_t kLongest = 4096;
    if (std::max(entry.name.size(), entry.abbreviation.size()) > kLongest) {
        damaged("the name of label " + std::to_string(entry.value) + " is longer than " +
                std::to_string(kLongest) + " bytes");
    }
    const auto [at, isNew] = places_.emplace(entry.value, table_.entries.size());
    if (isNew) {
        table_.entries.push_back(std::move(entry));
    } else if (!(table_.entries[at->second] == entry) && repeats_++ == 0) {
        firstRepeat_ = entry.value;
    }
}

void Collector::add(LabelEntry entry, const Channels& channels, const std::string& where) {
    raws_.push_back({entry.value, channels, where});
    entry.color = LabelColor{};  // set by scaleColors(); what tells entries of one value apart
    for (std::size_t n = 0; n < 3; ++n) {
        const double part = std::clamp(channels[n], 0.0, 255.0);
        (*entry.color)[n] = static_cast<std::uint8_t>(std::lround(part));
    }
    add(std::move(entry));
}

void Collector::leaveColorOut(const std::string& where, std::string_view text) {
    if (unread_++ == 0) firstUnread_ = "that of " + where + " is " + printable(text);
}

std::optional<LabelColor> Collector::colorOf(std::string_view text, const std::string& where,
                                             bool endsTable) {
    constexpr std::size_t kLongestShort = 5;  // #RGBA
    const bool isShort = text.starts_with('#') && text.size() <= kLongestShort;
    std::optional<LabelColor> color;
    if (!(isShort && endsTable && hasLongColor_)) color = parseColor(text);
    hasLongColor_ = hasLongColor_ || (color && !isShort);
    if (!color && !text.empty()) leaveColorOut(where, text);
    return color;
}

void Collector::scaleColors(bool areParts) {
    const auto isGood = [](double value) { return value >= 0 && value <= 255; };
    const auto isPart = [](double value) { return value >= 0 && value <= 1; };
    bool areAllParts = true, isAnyFraction = areParts;
    for (const Raw& raw : raws_) {
        for (const double value : raw.channels) {
            areAllParts = areAllParts && isPart(value);
            isAnyFraction = isAnyFraction || value != std::floor(value);
        }
    }
    const double scale = areAllParts && isAnyFraction ? 255 : 1;
    std::set<std::int64_t> done;
    std::size_t bad = 0;
    for (const Raw& raw : raws_) {
        if (!done.insert(raw.value).second) continue;  // the first counts
        LabelEntry& entry = table_.entries[places_.at(raw.value)];
        entry.color.reset();
        if (!std::ranges::all_of(raw.channels, isGood)) {
            std::string text;
            for (const double value : raw.channels) {
                text += (text.empty() ? "" : " ") + formatShort(value);
            }
            leaveColorOut(raw.where, text);
            ++bad;
            continue;
        }
        LabelColor color{};
        for (std::size_t n = 0; n < 3; ++n) {
            color[n] = static_cast<std::uint8_t>(std::lround(scale * raw.channels[n]));
        }
        entry.color = color;
    }
    // numbers of another kind, such as places
    if (2 * bad > done.size()) {
        for (LabelEntry& entry : table_.entries) entry.color.reset();
    }
}

LabelTable Collector::finish(bool areParts) {
    if (table_.entries.empty()) damaged("it lists no label");
    scaleColors(areParts);
    if (unread_ > 0) {
        table_.warnings.push_back(
            {"colors-not-read",
             (unread_ == 1 ? "a colour is left out: "
                           : std::to_string(unread_) + " colours are left out: ") +
                 firstUnread_ + ", must be #RRGGBB, or red, green and blue of 0 to 255"});
    }
    if (repeats_ > 0) {
        table_.warnings.push_back(
            {"label-listed-twice",
             (repeats_ == 1 ? "label " + std::to_string(firstRepeat_) + " is listed twice"
                            : std::to_string(repeats_) + " labels are listed twice, " +
                                  std::to_string(firstRepeat_) + " among them") +
                 " with different names or colours; the first counts"});
    }
    std::ranges::sort(table_.entries, {}, &LabelEntry::value);
    return std::move(table_);
}

}  // namespace adaptiso::labelnames
