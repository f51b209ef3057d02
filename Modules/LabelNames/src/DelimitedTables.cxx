// Tables with one separator between fields: BIDS (tabs) and 3D Slicer (commas).
#include <algorithm>
#include <array>

#include "Rows.h"

namespace adaptiso::labelnames {
namespace {

using Fields = std::vector<std::string>;

/// Fields between separators; one in double quotes may hold separators and, doubled, quotes.
/// Tab-separated ones know no quotes.
Fields split(const Line& line, char separator) {
    Fields fields(1);
    bool isQuoted = false;
    for (std::size_t n = 0; n < line.text.size(); ++n) {
        const char c = line.text[n];
        if (separator != '\t' && c == '"') {
            const bool isDoubled = isQuoted && line.text.substr(n + 1).starts_with('"');
            if (isDoubled) {
                fields.back() += '"';
                ++n;
            } else {
                isQuoted = !isQuoted;
            }
        } else if (c == separator && !isQuoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    if (isQuoted) damaged(place(line) + "a quote is not closed");
    for (std::string& field : fields) field = std::string(trimmed(field));
    return fields;
}

/// Where the columns are that a header names; -1: nowhere.
struct Columns {
    int index = -1, name = -1, abbreviation = -1, color = -1;
    std::array<int, 3> channels{-1, -1, -1};

    bool isTable() const { return index >= 0 && name >= 0; }
    bool hasChannels() const { return std::ranges::min(channels) >= 0; }
};

using Words = std::initializer_list<std::string_view>;

int findColumn(const Fields& header, const Words& names) {
    for (const std::string_view name : names) {
        for (std::size_t n = 0; n < header.size(); ++n) {
            std::string field = lowerCase(header[n]);
            std::ranges::replace(field, ' ', '_');
            if (field == name) return static_cast<int>(n);
        }
    }
    return -1;
}

Columns columnsOf(const Fields& header) {
    Columns columns;
    columns.index = findColumn(
        header, {"index", "labelvalue", "label_value", "value", "key", "id", "label_id", "roi_id"});
    columns.name = findColumn(
        header, {"name", "labelname", "label_name", "region", "structure", "roi_name", "label"});
    columns.abbreviation = findColumn(header, {"abbreviation", "acronym"});
    columns.color = findColumn(header, {"color", "colour", "hex", "color_hex_triplet"});
    columns.channels = {findColumn(header, {"color_r", "red", "r"}),
                        findColumn(header, {"color_g", "green", "g"}),
                        findColumn(header, {"color_b", "blue", "b"})};
    return columns;
}

char separatorOf(std::string_view line) {
    for (const char separator : {'\t', ','}) {
        if (line.find(separator) != std::string_view::npos) return separator;
    }
    return '\0';
}

/// The text of a field; empty where the row has none, or says that it has none.
std::string fieldOf(const Fields& row, int column) {
    if (column < 0 || static_cast<std::size_t>(column) >= row.size()) return {};
    return row[column] == "n/a" ? std::string() : row[column];
}

std::optional<LabelColor> colorOf(const Fields& row, const Columns& columns, const Line& line) {
    if (const std::string text = fieldOf(row, columns.color); !text.empty()) {
        const std::optional<LabelColor> color = parseHex(text);
        if (!color) damaged(place(line) + "the colour is " + printable(text) + ", must be #RRGGBB");
        return color;
    }
    if (!columns.hasChannels()) return std::nullopt;
    LabelColor color{};
    for (std::size_t n = 0; n < 3; ++n) {
        const std::string text = fieldOf(row, columns.channels[n]);
        if (text.empty()) return std::nullopt;
        color[n] = channelOf(text, line);
    }
    return color;
}

}  // namespace

bool isDelimited(std::string_view text) {
    const std::vector<Line> lines = linesOf(text);
    if (lines.empty()) return false;
    const char separator = separatorOf(lines.front().text);
    if (separator == '\0') return false;
    if (columnsOf(split(lines.front(), separator)).isTable()) return true;
    return separator != '\t' && wholeNumber(split(lines.front(), separator).front());
}

LabelTable decodeDelimited(std::string_view text) {
    const std::vector<Line> lines = linesOf(text);
    const char separator = separatorOf(lines.front().text);
    const Fields header = split(lines.front(), separator);
    Columns columns = columnsOf(header);
    const bool hasHeader = columns.isTable();
    if (!hasHeader) columns = {.index = 0, .name = 1};
    Collector found(separator == '\t'                         ? "BIDS"
                    : findColumn(header, {"labelvalue"}) >= 0 ? "3D Slicer"
                                                              : "comma-separated");
    for (std::size_t n = hasHeader ? 1 : 0; n < lines.size(); ++n) {
        const Line& line = lines[n];
        const Fields row = split(line, separator);
        const std::string index = fieldOf(row, columns.index), name = fieldOf(row, columns.name);
        if (row.size() < 2) {
            damaged(place(line) + "it has one field, must be an index and a name");
        }
        found.add({valueOf(index, line), name, fieldOf(row, columns.abbreviation),
                   colorOf(row, columns, line)});
    }
    return found.finish();
}

}  // namespace adaptiso::labelnames
