#include "Rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace adaptiso::labelnames {
void damaged(const std::string& what) {
    throw FileError(what + "; the table is damaged: mend or replace it");
}

void refuseKind(const std::string& why) {
    throw NoLabelTable(
        "is no table of labels that can be read (BIDS .tsv, FreeSurfer, ITK-SNAP, "
        "3D Slicer, MRIcron, FSL, GIFTI, JSON): " +
        why);
}

std::vector<Line> linesOf(std::string_view text) {
    std::vector<Line> lines;
    std::int64_t number = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        const std::string_view line = text.substr(0, end);
        const bool isTwo = text.substr(end).starts_with("\r\n");
        text.remove_prefix(std::min(text.size(), end + (isTwo ? 2 : 1)));
        ++number;
        const std::string_view words = trimmed(line);
        if (!words.empty() && words.front() != '#') lines.push_back({number, line});
    }
    return lines;
}

std::string place(const Line& line) {
    return "line " + std::to_string(line.number) + ": ";
}

std::optional<double> realNumber(std::string_view word) {
    word = trimmed(word);
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const char* const end = word.data() + word.size();
    const auto [last, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<std::int64_t> wholeNumber(std::string_view word) {
    const std::optional<double> value = realNumber(word);
    constexpr double kMost = 1e15;  // exact in double
    if (!value || *value != std::floor(*value) || std::abs(*value) > kMost) return std::nullopt;
    return static_cast<std::int64_t>(*value);
}

std::int32_t valueOf(std::string_view word, const Line& line) {
    const std::optional<std::int64_t> value = wholeNumber(word);
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (!value || *value < -kMost || *value > kMost) {
        damaged(place(line) + "the index is " + printable(word) +
                ", must be a whole number that 32 bits hold");
    }
    return static_cast<std::int32_t>(*value);
}

std::uint8_t channelOf(std::string_view word, const Line& line) {
    const std::optional<double> value = realNumber(word);
    if (!value || *value < 0 || *value > 255) {
        damaged(place(line) + "a colour has " + printable(word) + ", must be 0 to 255");
    }
    return static_cast<std::uint8_t>(std::lround(*value));
}

std::optional<LabelColor> parseHex(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('#')) text.remove_prefix(1);
    if (text.size() != 6 && text.size() != 8) return std::nullopt;  // 8: with opacity
    LabelColor color{};
    for (std::size_t n = 0; n < text.size() / 2; ++n) {
        std::uint8_t channel = 0;
        const char* const begin = text.data() + 2 * n;
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

LabelTable Collector::finish() {
    if (table_.entries.empty()) damaged("it lists no label");
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
