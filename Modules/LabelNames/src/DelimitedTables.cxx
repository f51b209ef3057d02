// Tables whose first line names their columns: BIDS (tabs), 3D Slicer (commas), CAT12 (semicolons).
#include <algorithm>
#include <array>
#include <set>

#include "Rows.h"
#include "adaptiso/Core/TextCells.h"

namespace adaptiso::labelnames {
namespace {

using Fields = std::vector<std::string>;

Fields split(const Line& line, char separator) {
    const std::optional<Fields> fields = cellsOf(line.text, separator);
    if (!fields) damaged(place(line) + "a quote is not closed");
    return *fields;
}

/// Where the columns are that a header names; -1: nowhere.
struct Columns {
    char separator = '\0';
    int index = -1, name = -1, abbreviation = -1, color = -1;
    std::array<int, 3> channels{-1, -1, -1};

    bool isTable() const { return index >= 0 && name >= 0 && index != name; }
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

/// Those of BIDS and 3D Slicer first.
const Words kIndexNames{"index",    "labelvalue", "label_value", "value", "key",          "id",
                        "label_id", "labelid",    "roi_id",      "roiid", "label_number", "label"};

Columns columnsOf(const Fields& header) {
    Columns columns;
    columns.index = findColumn(header, kIndexNames);
    columns.name = findColumn(
        header, {"name", "labelname", "label_name", "region", "region_name", "structure",
                 "structure_name", "roi_name", "roiname", "totalsegmentator_name", "label"});
    columns.abbreviation = findColumn(header, {"abbreviation", "acronym", "roiabbr"});
    columns.color = findColumn(header, {"color", "colour", "hex", "color_hex_triplet"});
    columns.channels = {findColumn(header, {"color_r", "red", "r"}),
                        findColumn(header, {"color_g", "green", "g"}),
                        findColumn(header, {"color_b", "blue", "b"})};
    return columns;
}

/// By the separator that makes a table of `line`; none if there is none.
Columns columnsOf(const Line& line) {
    for (const char separator : {'\t', ';', ','}) {
        const std::optional<Fields> header = cellsOf(line.text, separator);
        if (!header) continue;
        Columns columns = columnsOf(*header);
        columns.separator = separator;
        if (columns.isTable()) return columns;
    }
    return {};
}

/// The text of a field; empty where the row has none, or says that it has none.
std::string fieldOf(const Fields& row, int column) {
    if (column < 0 || static_cast<std::size_t>(column) >= row.size()) return {};
    return row[column] == "n/a" ? std::string() : row[column];
}

/// Empty where one is missing.
std::optional<Channels> channelsOf(const Fields& row, const Columns& columns) {
    if (!columns.hasChannels()) return std::nullopt;
    Channels channels{};
    for (std::size_t n = 0; n < 3; ++n) {
        const std::string text = fieldOf(row, columns.channels[n]);
        if (isMissing(text)) return std::nullopt;
        // what is no number is no colour
        channels[n] = cellNumber(text, columns.separator).value_or(-1);
    }
    return channels;
}

/// A row may lack cells at its end: none before a colour.
void requireCells(const Fields& row, const Line& line, const Fields& header,
                  const Columns& columns) {
    if (row.size() < 2) damaged(place(line) + "it has one field, must be an index and a name");
    std::size_t count = row.size();
    while (count > header.size() && row[count - 1].empty()) --count;
    const bool isColor = row.back().starts_with('#') && parseColor(row.back());
    const bool lacksOne = isColor && columns.color >= std::ssize(row);
    if (count <= header.size() && !lacksOne) return;
    damaged(place(line) + "it has " + std::to_string(count) + " fields, the header " +
            std::to_string(header.size()) +
            (columns.separator == ',' ? " (a name with a comma must be in double quotes)" : ""));
}

/// The whole numbers of a column; empty where it holds something else, or one of them twice.
std::vector<std::int64_t> labelsOf(const std::vector<Fields>& rows, int column) {
    std::vector<std::int64_t> labels;
    for (const Fields& row : rows) {
        const auto label = wholeNumber(fieldOf(row, column));
        if (!label) return {};
        labels.push_back(*label);
    }
    const std::set<std::int64_t> distinct(labels.begin(), labels.end());
    return distinct.size() == labels.size() ? labels : std::vector<std::int64_t>();
}

/// The column of the labels where several may be. BIDS's and 3D Slicer's are, unless they count the
/// rows from 0; `value` may be a measure.
int chooseIndex(const Fields& header, const std::vector<Fields>& rows, const Columns& columns) {
    const int label = findColumn(header, {"label"});
    if (columns.index == findColumn(header, {"value"}) && label != columns.name &&
        !labelsOf(rows, label).empty()) {
        return label;
    }
    const std::vector<std::int64_t> chosen = labelsOf(rows, columns.index);
    if (chosen.empty()) return columns.index;
    const bool countsRows = chosen.front() == 0 && std::ranges::is_sorted(chosen) &&
                            chosen.back() + 1 == std::ssize(chosen);
    const bool isStandard =
        columns.index == findColumn(header, {"index", "labelvalue", "label_value"});
    for (const std::string_view name : kIndexNames) {
        const int other = findColumn(header, {name});
        if (other < 0 || other == columns.index || other == columns.name) continue;
        const std::vector<std::int64_t> labels = labelsOf(rows, other);
        if (labels.empty() || labels == chosen || (isStandard && !countsRows)) continue;
        throw FileError("its columns " + printable(header[columns.index]) + " and " +
                        printable(header[other]) +
                        " may both be the labels, and differ: remove the wrong one");
    }
    return columns.index;
}

/// True if the first line names columns, among them an index and a name.
bool isDelimited(const TableFile& file) {
    if (file.first == '<' || file.first == '{' || file.first == '[') return false;
    const std::vector<Line> lines = linesOf(file.text);
    return !lines.empty() && columnsOf(lines.front()).isTable();
}

LabelTable decodeDelimited(const TableFile& file) {
    const std::vector<Line> lines = linesOf(file.text);
    Columns columns = columnsOf(lines.front());
    const Fields header = split(lines.front(), columns.separator);
    const bool isSlicer = findColumn(header, {"labelvalue"}) >= 0;
    Collector found(columns.separator == '\t'  ? "BIDS"
                    : isSlicer                 ? "3D Slicer"
                    : columns.separator == ';' ? "semicolon-separated"
                                               : "comma-separated");
    std::vector<Line> filled;
    std::vector<Fields> rows;
    for (std::size_t n = 1; n < lines.size(); ++n) {
        const Line& line = lines[n];
        Fields row = split(line, columns.separator);
        if (std::ranges::all_of(row, &std::string::empty)) continue;
        requireCells(row, line, header, columns);
        filled.push_back(line);
        rows.push_back(std::move(row));
    }
    columns.index = chooseIndex(header, rows, columns);
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const Line& line = filled[n];
        const Fields& row = rows[n];
        const std::string where = "line " + std::to_string(line.number);
        LabelEntry entry{valueOf(fieldOf(row, columns.index), line, columns.separator),
                         fieldOf(row, columns.name),
                         fieldOf(row, columns.abbreviation),
                         {}};
        const std::string color = fieldOf(row, columns.color);
        entry.color = found.colorOf(color, where, endsText(line, file.text));
        const std::optional<Channels> channels = channelsOf(row, columns);
        if (color.empty() && channels) {
            found.add(std::move(entry), *channels, where);
        } else {
            found.add(std::move(entry));
        }
    }
    return found.finish();
}

}  // namespace

extern const TableCodec kDelimitedTables{isDelimited, decodeDelimited};

}  // namespace adaptiso::labelnames
