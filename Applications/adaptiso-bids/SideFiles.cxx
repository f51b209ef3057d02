#include "SideFiles.h"

#include <fnmatch.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <span>

#include "Common/UsageWords.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/Json/Json.h"

namespace adaptiso::bids {
namespace {

namespace fs = std::filesystem;

/// What stands for one character each: "a", "?", "[a-z]", "\\*"; "*" stands for any number of
/// them, and "**" alone for any number of folders.
using Elements = std::vector<std::string>;

Elements elementsOf(const std::string& pattern) {
    if (pattern == "**") return {pattern};
    Elements elements;
    for (std::size_t at = 0; at < pattern.size();) {
        std::size_t end = at + 1;
        if (pattern[at] == '\\' && end < pattern.size()) ++end;
        if (pattern[at] == '[') {
            std::size_t first = end;
            if (first < pattern.size() && (pattern[first] == '!' || pattern[first] == '^')) ++first;
            const std::size_t close = pattern.find(']', first + 1);
            if (close != std::string::npos) end = close + 1;
        }
        std::string element = pattern.substr(at, end - at);
        at = end;
        const bool isRepeated = element == "*" && !elements.empty() && elements.back() == "*";
        if (!isRepeated) elements.push_back(std::move(element));
    }
    return elements;
}

bool fitsCharacter(const std::string& element, char c) {
    if (element.size() == 1) return element[0] == '?' || element[0] == c;
    const char text[] = {c, '\0'};
    return fnmatch(element.c_str(), text, 0) == 0;
}

/// Goes back to the last "*" alone, so that no pattern takes longer than both lengths' product.
bool fitsName(const Elements& pattern, const std::string& name) {
    std::size_t p = 0, n = 0, star = pattern.size(), from = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == "*") {
            star = p++;
            from = n;
        } else if (p < pattern.size() && fitsCharacter(pattern[p], name[n])) {
            ++p;
            ++n;
        } else if (star < pattern.size()) {
            p = star + 1;
            n = ++from;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == "*") ++p;
    return p == pattern.size();
}

/// Matches the path or a folder above it.
bool fits(std::span<const Elements> pattern, std::span<const std::string> path) {
    if (pattern.empty()) return true;
    const bool isAnyFolder = pattern[0] == Elements{"**"};
    if (isAnyFolder && fits(pattern.subspan(1), path)) return true;
    if (path.empty()) return false;
    if (isAnyFolder) return fits(pattern, path.subspan(1));
    return fitsName(pattern[0], path[0]) && fits(pattern.subspan(1), path.subspan(1));
}

/// Parts of `path` that are not empty.
std::vector<std::string> partsOf(const std::string& path) {
    std::vector<std::string> parts = splitAt(path, '/');
    std::erase(parts, "");
    return parts;
}

void requireText(std::string_view text) {
    if (const std::string fault = faultOfText(text); !fault.empty()) throw FileError(fault);
}

}  // namespace

std::string withPrefix(const std::string& label, const std::string& prefix) {
    return label.starts_with(prefix) ? label : prefix + label;
}

std::vector<std::string> splitAt(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    }
    return parts;
}

BidsIgnore::BidsIgnore(std::string_view text) {
    requireText(text);
    TextLines lines(text);
    while (const auto whole = lines.next()) {
        std::string line(*whole);
        while (!line.empty() && (line.back() == '\t' || line.back() == ' ')) line.pop_back();
        if (line.empty() || line[0] == '#') continue;
        Rule rule{{}, line[0] == '!'};
        if (rule.isException) line.erase(0, 1);
        const std::size_t slash = line.find('/');
        std::vector<std::string> parts = partsOf(line);
        if (parts.empty()) continue;
        // without a slash, except at its end, it is a name anywhere
        if (slash == std::string::npos || slash + 1 == line.size()) {
            parts.insert(parts.begin(), "**");
        }
        parts.erase(std::unique(parts.begin(), parts.end(),
                                [](const std::string& a, const std::string& b) {
                                    return a == "**" && b == "**";
                                }),
                    parts.end());
        for (const std::string& part : parts) rule.pattern.push_back(elementsOf(part));
        rules_.push_back(std::move(rule));
    }
}

bool BidsIgnore::contains(const fs::path& path) const {
    const std::vector<std::string> parts = partsOf(path.generic_string());
    bool isIgnored = false;
    for (const Rule& rule : rules_) {
        if (fits(rule.pattern, parts)) isIgnored = !rule.isException;
    }
    return isIgnored;
}

namespace {

/// Calls take(participant, cell of the column, empty where there is none) for each line of
/// participants.tsv. \throws FileError
void forEachParticipant(
    std::string_view text, std::string_view wanted,
    const std::function<void(const std::string& participant, const std::string& cell)>& take) {
    requireText(text);
    TextLines lines(text);
    const std::string_view first = lines.next().value_or("");
    const char separator = separatorOf(first);
    const auto cells = [&](std::string_view line) {
        return cellsOf(line, separator).value_or(std::vector<std::string>());
    };
    const std::vector<std::string> header = cells(first);
    const auto columnOf = [&](std::string_view name) {
        return static_cast<std::size_t>(std::ranges::find(header, name) - header.begin());
    };
    const std::size_t id = columnOf("participant_id"), column = columnOf(wanted);
    if (id == header.size()) throw FileError("its first line names no column 'participant_id'");
    while (const auto line = lines.next()) {
        const std::vector<std::string> row = cells(*line);
        if (id >= row.size() || isMissing(row[id])) continue;
        take(withPrefix(row[id], "sub-"), column < row.size() ? row[column] : std::string());
    }
}

/// \throws FileError  the unit is not known
double yearsOf(const std::string& unit) {
    constexpr double kDays = 365.25;
    if (unit.starts_with("y") || unit == "a") return 1;
    if (unit.starts_with("mo")) return 1.0 / 12;
    if (unit.starts_with("w")) return 7 / kDays;
    if (unit.starts_with("d")) return 1 / kDays;
    throw FileError("the unit of 'age', " + shown(unit) +
                    ", is none of years, months, weeks, days");
}

}  // namespace

std::set<std::string> participantsIn(std::string_view text) {
    std::set<std::string> listed;
    forEachParticipant(text, "participant_id",
                       [&](const std::string& id, const std::string&) { listed.insert(id); });
    return listed;
}

std::map<std::string, double> agesIn(std::string_view text, std::string_view description) {
    constexpr double kMostYears = 120;
    std::map<std::string, double> ages;
    const auto json = parseJson<Json>(description);
    const Json age = json.is_object() ? json.value("age", Json()) : Json();
    const Json unit = age.is_object() ? age.value("Units", Json()) : Json();
    const double unitYears = unit.is_string() ? yearsOf(lowerCase(unit.get<std::string>())) : 1;
    forEachParticipant(text, "age", [&](const std::string& id, const std::string& cell) {
        double years = -1;
        const char* const end = cell.data() + cell.size();
        const auto [last, error] = std::from_chars(cell.data(), end, years);
        const bool isNumber = error == std::errc() && last == end;
        years *= unitYears;
        if (isNumber && years >= 0 && years <= kMostYears) ages[id] = years;
    });
    return ages;
}

std::string missingKeyOf(std::string_view description) {
    requireText(description);
    const auto json = parseJson<Json>(description);
    for (const char* const key : {"Name", "BIDSVersion"}) {
        if (!json.is_object() || !json.contains(key) || !json[key].is_string()) return key;
    }
    return {};
}

}  // namespace adaptiso::bids
