// Tables of words with blanks between them: FreeSurfer, 3D Slicer's older ones, ITK-SNAP, MRIcron.
#include <algorithm>
#include <set>

#include "Rows.h"

namespace adaptiso::labelnames {
namespace {

struct Row {
    Line line;
    std::vector<std::string_view> words;

    /// From the start of word `first` to the end of word `last`.
    std::string span(std::size_t first, std::size_t last) const {
        const char* const begin = words[first].data();
        return {begin, static_cast<std::size_t>(words[last].data() + words[last].size() - begin)};
    }
};

std::vector<Row> rowsOf(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\v\f";
    std::vector<Row> rows;
    for (const Line& line : linesOf(text)) {
        Row row{line, {}};
        for (std::size_t at = line.text.find_first_not_of(kBlanks); at < line.text.size();
             at = line.text.find_first_not_of(kBlanks, at)) {
            const std::size_t end =
                std::min(line.text.find_first_of(kBlanks, at), line.text.size());
            row.words.push_back(line.text.substr(at, end - at));
            at = end;
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Most rows hold an index, a name and this many numbers.
bool isColorTable(const std::vector<Row>& rows, std::ptrdiff_t numbers) {
    const auto endsInColor = [numbers](const Row& row) {
        return std::ssize(row.words) >= numbers + 2 &&
               std::all_of(row.words.end() - numbers, row.words.end(),
                           [](auto word) { return realNumber(word).has_value(); });
    };
    // one row with a fault is reported as such, not as a file of another kind
    return 2 * std::ranges::count_if(rows, endsInColor) > std::ssize(rows);
}

bool isSnapTable(const std::vector<Row>& rows) {
    const auto isSnap = [](const Row& row) {
        return row.words.size() >= 8 && row.words[7].starts_with('"') &&
               std::all_of(row.words.begin(), row.words.begin() + 7,
                           [](auto word) { return realNumber(word).has_value(); });
    };
    return 2 * std::ranges::count_if(rows, isSnap) > std::ssize(rows);
}

/// \param numbers  of a colour: 4, or 3 without opacity
LabelTable decodeColorTable(const std::vector<Row>& rows, std::size_t numbers, bool isSlicer) {
    Collector found(isSlicer ? "3D Slicer" : "FreeSurfer");
    for (const Row& row : rows) {
        const std::size_t count = row.words.size();
        if (count < numbers + 2) {
            damaged(place(row.line) + "it has " + std::to_string(count) +
                    " words, must be an index, a name and " + std::to_string(numbers) +
                    " numbers of a colour");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = row.span(1, count - numbers - 1);
        if (isSlicer) std::ranges::replace(entry.name, '_', ' ');
        LabelColor color{};
        for (std::size_t n = 0; n < 3; ++n) {
            color[n] = channelOf(row.words[count - numbers + n], row.line);
        }
        entry.color = color;
        found.add(std::move(entry));
    }
    return found.finish();
}

LabelTable decodeSnap(const std::vector<Row>& rows) {
    Collector found("ITK-SNAP");
    for (const Row& row : rows) {
        const std::string_view text = row.line.text;
        const std::size_t open = text.find('"'), close = text.rfind('"');
        if (row.words.size() < 8 || close == open || close == std::string_view::npos) {
            damaged(place(row.line) +
                    "it must hold an index, six numbers and a name in double quotes");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = text.substr(open + 1, close - open - 1);
        LabelColor color{};
        for (std::size_t n = 0; n < 3; ++n) color[n] = channelOf(row.words[1 + n], row.line);
        entry.color = color;
        found.add(std::move(entry));
    }
    return found.finish();
}

/// True if the last word of every row is a number that is no part of its name: the names are
/// distinct without it ("Precentral_L 2001", unlike "Area 44").
bool endsInCode(const std::vector<Row>& rows) {
    std::set<std::string> names;
    for (const Row& row : rows) {
        if (row.words.size() < 3 || !wholeNumber(row.words.back())) return false;
        names.insert(row.span(1, row.words.size() - 2));
    }
    return 2 * names.size() > rows.size();
}

LabelTable decodeNames(const std::vector<Row>& rows) {
    Collector found("MRIcron");
    const bool hasCode = endsInCode(rows);
    for (const Row& row : rows) {
        if (row.words.size() < 2) {
            damaged(place(row.line) + "it has one word, must be an index and a name");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = row.span(1, row.words.size() - (hasCode ? 2 : 1));
        found.add(std::move(entry));
    }
    return found.finish();
}

}  // namespace

LabelTable decodeSpaced(std::string_view text) {
    const std::vector<Row> rows = rowsOf(text);
    const auto hasIndex = [](const Row& row) { return wholeNumber(row.words[0]).has_value(); };
    if (rows.empty()) refuseKind("it holds nothing but comments");
    if (2 * std::ranges::count_if(rows, hasIndex) <= std::ssize(rows)) {
        refuseKind("its lines do not begin with a label's number");
    }
    if (isSnapTable(rows)) return decodeSnap(rows);
    const bool isSlicer = text.find("# Color table file") != std::string_view::npos ||
                          text.find("# 3D Slicer") != std::string_view::npos;
    for (const std::size_t numbers : {4U, 3U}) {
        if (isColorTable(rows, static_cast<std::ptrdiff_t>(numbers))) {
            return decodeColorTable(rows, numbers, isSlicer);
        }
    }
    return decodeNames(rows);
}

}  // namespace adaptiso::labelnames
