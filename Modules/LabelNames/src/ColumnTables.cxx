// Tables without a header: what their columns hold says whose they are. Numbers that stand beside a
// name are never taken for a part of it: a table of other columns is refused.
#include <algorithm>
#include <array>
#include <set>

#include "Rows.h"
#include "adaptiso/Core/TextCells.h"

namespace adaptiso::labelnames {
namespace {

bool isNumber(std::string_view word) {
    return realNumber(word).has_value();
}

/// A table's line in words. The first is a label's number, in most tables.
struct Row {
    Line line;
    std::vector<std::string_view> words;
    bool hasCells = false;  ///< words are cells between separators

    std::size_t size() const { return words.size(); }
    /// Numbers that follow the first word.
    std::size_t leading() const {
        std::size_t count = 0;
        while (count + 1 < size() && isNumber(words[count + 1])) ++count;
        return count;
    }
    /// Numbers at the end, behind the first word.
    std::size_t trailing() const {
        std::size_t count = 0;
        while (count + 1 < size() && isNumber(words[size() - 1 - count])) ++count;
        return count;
    }
    bool isNumbersAlone() const { return leading() + 1 == size(); }
    /// The words from `first` to before `end`, as the line has them; of cells the first that is
    /// filled.
    std::string name(std::size_t first, std::size_t end) const {
        if (hasCells) {
            while (first + 1 < end && words[first].empty()) ++first;
            end = first + 1;
        }
        const char* const begin = words[first].data();
        std::string_view text(begin, words[end - 1].data() + words[end - 1].size() - begin);
        const bool isQuoted = !hasCells && text.size() > 1 && text.front() == '"' &&
                              text.find('"', 1) == text.size() - 1;
        return std::string(isQuoted ? text.substr(1, text.size() - 2) : text);
    }
    std::string where() const { return "line " + std::to_string(line.number); }
    Channels channels(std::size_t first) const {
        Channels channels{};
        for (std::size_t n = 0; n < 3; ++n) channels[n] = *realNumber(words[first + n]);
        return channels;
    }
};

using Rows = std::vector<Row>;

template <class Holds>
bool areMost(const Rows& rows, const Holds& holds) {
    // one row with a fault is reported as such, not as a file of another kind
    return 2 * std::ranges::count_if(rows, holds) > std::ssize(rows);
}

/// Words between blanks; what is in double quotes is one, with its quotes. A comment at the end is
/// left out: it begins with # and a blank, or follows numbers and is neither a number nor a colour.
std::vector<std::string_view> wordsOf(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\v\f";
    std::vector<std::string_view> words;
    for (std::size_t at = text.find_first_not_of(kBlanks); at < text.size();
         at = text.find_first_not_of(kBlanks, at)) {
        std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
        if (text[at] == '"') {
            std::size_t close = text.find('"', at + 1);
            while (close < text.size() && close + 1 < text.size() &&
                   kBlanks.find(text[close + 1]) == kBlanks.npos) {
                close = text.find('"', close + 1);
            }
            if (close < text.size()) end = close + 1;
        }
        const std::string_view word = text.substr(at, end - at);
        at = end;
        if (word.front() == '#' && !words.empty()) {
            const bool isAlone = word.find_first_not_of('#') == word.npos;
            const bool isText = !isNumber(word.substr(1)) && !parseColor(word);
            if (isAlone || (isText && words.size() > 2 && isNumber(words.back()))) break;
        }
        words.push_back(word);
    }
    return words;
}

/// Rows of cells that `separator` parts: at least two in each, the first a label's number, and one
/// column of text at most where that is a tab.
std::optional<Rows> rowsOfCells(const std::vector<Line>& lines, char separator,
                                std::vector<std::vector<std::string>>& cells) {
    Rows rows;
    for (const Line& line : lines) {
        auto row = cellsOf(line.text, separator);
        if (!row) {
            if (separator == '\t' ||
                !wholeNumber(lines.front().text.substr(0, lines.front().text.find(separator)))) {
                return std::nullopt;
            }
            damaged(place(line) + "a quote is not closed");
        }
        while (!row->empty() && row->back().empty()) row->pop_back();
        if (row->empty()) continue;
        cells.push_back(std::move(*row));
        rows.push_back({line, {cells.back().begin(), cells.back().end()}, true});
    }
    if (rows.empty()) return std::nullopt;
    const auto hasIndex = [](const Row& row) {
        return row.size() > 1 && wholeNumber(row.words[0]);
    };
    const auto hasOneText = [&](const Row& row) {
        return hasIndex(row) && std::ranges::count_if(row.words, [](std::string_view word) {
                                    return !isNumber(word);
                                }) == 1;
    };
    const bool isTable = separator == '\t'
                             ? std::ranges::all_of(rows, hasOneText) && rows.front().size() > 2
                             : areMost(rows, hasIndex);
    return isTable ? std::optional(rows) : std::nullopt;
}

Rows rowsOfWords(const std::vector<Line>& lines) {
    Rows rows;
    for (const Line& line : lines) rows.push_back({line, wordsOf(line.text)});
    return rows;
}

[[noreturn]] void refuseColumns(const std::string& what) {
    throw FileError("its columns are those of no table that is read: " + what +
                    "; give a table with the header index, name, color (BIDS)");
}

/// ITK-SNAP: six numbers, the name in quotes.
bool isSnapTable(const Rows& rows) {
    return areMost(rows, [](const Row& row) {
        return row.size() >= 8 && row.words[7].starts_with('"') && row.leading() >= 6;
    });
}

LabelTable decodeSnap(const Rows& rows) {
    Collector found("ITK-SNAP");
    for (const Row& row : rows) {
        const std::string_view text = row.line.text;
        const std::size_t open = text.find('"'), close = text.rfind('"');
        if (row.size() < 8 || row.leading() < 6 || close == open ||
            close == std::string_view::npos) {
            damaged(place(row.line) +
                    "it must hold an index, six numbers and a name in double quotes");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = text.substr(open + 1, close - open - 1);
        found.add(std::move(entry), row.channels(1), row.where());
    }
    return found.finish();
}

/// Connectome Workbench (wb_command -volume-label-import): a line with a name, one with an index,
/// R, G, B and A.
bool isWorkbenchList(const Rows& rows) {
    if (rows.size() % 2 != 0) return false;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const bool isColor = rows[n].size() == 5 && rows[n].leading() == 4 &&
                             wholeNumber(rows[n].words[0]).has_value();
        if (isColor != (n % 2 == 1)) return false;
    }
    return true;
}

LabelTable decodeWorkbench(const Rows& rows) {
    Collector found("Connectome Workbench");
    for (std::size_t n = 0; n < rows.size(); n += 2) {
        LabelEntry entry;
        entry.value = valueOf(rows[n + 1].words[0], rows[n + 1].line);
        entry.name = trimmed(rows[n].line.text);
        found.add(std::move(entry), rows[n + 1].channels(1), rows[n + 1].where());
    }
    return found.finish();
}

/// SPM's and MRtrix's AAL: abbreviation, name and index.
bool isAal(const Rows& rows) {
    std::set<std::int64_t> indices;
    for (const Row& row : rows) {
        const auto index = wholeNumber(row.words.back());
        if (row.size() != 3 || isNumber(row.words[0]) || isNumber(row.words[1]) || !index ||
            !indices.insert(*index).second) {
            return false;
        }
    }
    return rows.size() > 1;
}

LabelTable decodeAal(const Rows& rows) {
    Collector found("AAL");
    for (const Row& row : rows) {
        LabelEntry entry;
        entry.value = valueOf(row.words[2], row.line);
        entry.name = row.name(1, 2);
        entry.abbreviation = row.name(0, 1);
        found.add(std::move(entry));
    }
    return found.finish();
}

/// Index, R, G, B, perhaps A, and a name: FSLeyes.
LabelTable decodeColorFirst(const Rows& rows) {
    std::size_t numbers = 4;
    for (const Row& row : rows) {
        if (row.leading() == 3 && !row.isNumbersAlone()) numbers = 3;
    }
    Collector found("FSLeyes");
    for (const Row& row : rows) {
        if (row.leading() < numbers || row.size() < numbers + 2) {
            damaged(place(row.line) + "it must hold an index, " + std::to_string(numbers) +
                    " numbers of a colour and a name");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = row.name(numbers + 1, row.size());
        found.add(std::move(entry), row.channels(1), row.where());
    }
    return found.finish(true);
}

/// True if `values`, one of each row, are what tables have for opacity.
bool isOpacity(const std::set<double>& values) {
    constexpr std::array kUsual{0.0, 1.0, 255.0};
    return values.size() == 1 && std::ranges::count(kUsual, *values.begin()) == 1;
}

/// True if the first of four numbers at the end is the name's: names would be the same without it,
/// and the last is no usual opacity.
bool areNamesNumbered(const Rows& rows) {
    std::set<std::string> names, numberedNames;
    std::set<double> last;
    std::size_t count = 0;
    for (const Row& row : rows) {
        if (row.trailing() > 4) return false;
        if (row.trailing() < 4 || row.size() < 6) continue;
        ++count;
        names.insert(row.name(1, row.size() - 4));
        numberedNames.insert(row.name(1, row.size() - 3));
        last.insert(*realNumber(row.words.back()));
    }
    return !isOpacity(last) && 2 * names.size() <= count && numberedNames.size() == count;
}

/// How many numbers follow the name in each row: R, G, B, perhaps A, and FreeSurfer's type of
/// tissue behind these, which a table may have in some rows alone. A name may end in a number too;
/// opacity, which is the same in most rows, tells.
std::vector<std::size_t> colorNumbers(const Rows& rows) {
    const auto numberAt = [](const Row& row, std::size_t fromEnd) {
        return *realNumber(row.words[row.size() - fromEnd]);
    };
    const bool hasOpacity = areMost(rows, [](const Row& row) { return row.trailing() >= 4; }) &&
                            !areNamesNumbered(rows);
    std::set<double> opacities, last, beforeLast;
    for (const Row& row : rows) {
        if (row.trailing() == 4) opacities.insert(numberAt(row, 1));
        if (row.trailing() < 5) continue;
        last.insert(numberAt(row, 1));
        beforeLast.insert(numberAt(row, 2));
    }
    const bool haveAll = opacities.empty() && isOpacity(beforeLast);
    if (haveAll) opacities = beforeLast;
    if (opacities.empty() || isOpacity(last)) opacities.merge(std::set(last));
    constexpr double kMostTissue = 20;
    const auto mayHaveTissue = [&](const Row& row) {
        const double type = row.trailing() < 5 ? -1 : numberAt(row, 1);
        return type >= 0 && type <= kMostTissue && opacities.contains(numberAt(row, 2));
    };
    const bool isSure = haveAll || std::ranges::any_of(rows, [&](const Row& row) {
                            return mayHaveTissue(row) && !opacities.contains(numberAt(row, 1));
                        });
    std::vector<std::size_t> numbers;
    for (const Row& row : rows) {
        const bool hasTissue = isSure && mayHaveTissue(row);
        numbers.push_back(!hasOpacity ? 3 : hasTissue ? 5 : 4);
    }
    return numbers;
}

/// MRtrix: an abbreviation such as "L.BSTS" before a name of one word.
bool hasAbbreviations(const Rows& rows, const std::vector<std::size_t>& numbers) {
    std::set<std::string_view> names;
    std::size_t count = 0;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        if (rows[n].size() != numbers[n] + 3) continue;
        if (rows[n].words[1].find('.') != std::string_view::npos) ++count;
        names.insert(rows[n].words[2]);
    }
    return 2 * count > rows.size() && 2 * names.size() > rows.size();
}

/// Index, name, R, G, B, perhaps A: FreeSurfer, 3D Slicer, MRtrix.
LabelTable decodeColorLast(const Rows& rows, bool isSlicer) {
    const std::vector<std::size_t> numbers = colorNumbers(rows);
    const bool isMrtrix = hasAbbreviations(rows, numbers);
    Collector found(isSlicer ? "3D Slicer" : isMrtrix ? "MRtrix" : "FreeSurfer");
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const Row& row = rows[n];
        if (row.trailing() < numbers[n] || row.size() < numbers[n] + 2) {
            damaged(place(row.line) + "it has " + std::to_string(row.size()) +
                    " words, must be an index, a name and " + std::to_string(numbers[n]) +
                    " numbers of a colour");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        const std::size_t end = row.size() - numbers[n];
        const bool isLong = isMrtrix && end == 3;
        entry.name = row.name(isLong ? 2 : 1, end);
        if (isLong) entry.abbreviation = row.name(1, 2);
        if (isSlicer) std::ranges::replace(entry.name, '_', ' ');
        found.add(std::move(entry), row.channels(end), row.where());
    }
    return found.finish();
}

bool isHex(std::string_view word) {
    return word.starts_with('#') && parseColor(word);
}

/// Index, and a name with #RRGGBB behind it or before.
LabelTable decodeHex(const Rows& rows, std::string_view text, bool isColorFirst) {
    Collector found("names with colours");
    for (const Row& row : rows) {
        if (row.size() < 3) {
            damaged(place(row.line) + "it must hold an index, a name and a colour");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = isColorFirst ? row.name(2, row.size()) : row.name(1, row.size() - 1);
        entry.color = found.colorOf(isColorFirst ? row.words[1] : row.words.back(), row.where(),
                                    !isColorFirst && endsText(row.line, text));
        found.add(std::move(entry));
    }
    return found.finish();
}

/// True if the last word of every row is a number that is no part of its name: the names are
/// distinct without it ("Precentral_L 2001", unlike "Area 44"), and all have three digits ("Crus 1"
/// has not) or are the indices, counted from another number (AAL3, AICHA).
bool endsInCode(const Rows& rows) {
    std::set<std::string> names;
    std::set<std::int64_t> offsets;
    bool areLong = true;
    for (const Row& row : rows) {
        const auto code = row.size() < 3 ? std::nullopt : wholeNumber(row.words.back());
        if (!code) return false;
        areLong = areLong && row.words.back().size() >= 3;
        offsets.insert(*code - wholeNumber(row.words[0]).value_or(0));
        names.insert(row.name(1, row.size() - 1));
    }
    const bool areIndices = offsets.size() == 1 && rows.size() > 1;
    return 2 * names.size() > rows.size() && (areLong || areIndices);
}

/// Index and name, perhaps a code behind it: MRIcron.
LabelTable decodeNames(const Rows& rows) {
    Collector found(rows.front().hasCells ? "separated names" : "MRIcron");
    const bool hasCode = endsInCode(rows);
    for (const Row& row : rows) {
        if (row.size() < 2) {
            damaged(place(row.line) + "it has one word, must be an index and a name");
        }
        LabelEntry entry;
        entry.value = valueOf(row.words[0], row.line);
        entry.name = row.name(1, row.size() - (hasCode ? 1 : 0));
        found.add(std::move(entry));
    }
    return found.finish();
}

Rows rowsOf(const std::vector<Line>& lines, std::vector<std::vector<std::string>>& cells) {
    const char separator = separatorOf(lines.front().text);
    if (separator != '\0') {
        cells.reserve(lines.size());
        if (auto rows = rowsOfCells(lines, separator, cells)) return *rows;
    }
    return rowsOfWords(lines);
}

LabelTable decodeRows(const TableFile& file) {
    const std::string_view text = file.text;
    const std::vector<Line> lines = linesOf(text);
    if (lines.empty()) refuseKind("it holds nothing but comments");
    std::vector<std::vector<std::string>> cells;  // which rows are views of
    const Rows rows = rowsOf(lines, cells);
    if (isWorkbenchList(rows)) return decodeWorkbench(rows);
    if (isAal(rows)) return decodeAal(rows);
    if (!areMost(rows, [](const Row& row) { return wholeNumber(row.words[0]).has_value(); })) {
        refuseKind("its lines do not begin with a label's number");
    }
    if (isSnapTable(rows)) return decodeSnap(rows);
    if (areMost(rows, &Row::isNumbersAlone)) {
        refuseKind("its lines hold numbers alone, no names");
    }
    const auto trails = [](std::size_t least, std::size_t most) {
        return [=](const Row& row) { return row.trailing() >= least && row.trailing() <= most; };
    };
    const auto leads = [](std::size_t least, std::size_t most) {
        return [=](const Row& row) {
            return !row.isNumbersAlone() && row.leading() >= least && row.leading() <= most;
        };
    };
    constexpr std::size_t kAny = 1000;
    const bool isColorFirst = areMost(rows, leads(3, 4)), isColorLast = areMost(rows, trails(3, 6));
    const bool isNumbered = areMost(rows, leads(1, kAny)),
               isMeasured = areMost(rows, trails(2, kAny));
    if (isColorFirst && !isMeasured) return decodeColorFirst(rows);
    if (isNumbered) refuseColumns("numbers stand between index and name, but no colour alone");
    if (isColorLast) {
        const bool isSlicer = text.find("# Color table file") != std::string_view::npos ||
                              text.find("# 3D Slicer") != std::string_view::npos;
        return decodeColorLast(rows, isSlicer);
    }
    if (isMeasured) refuseColumns("numbers stand behind the name, but no colour alone");
    const auto beginsWithHex = [](const Row& row) { return row.size() > 2 && isHex(row.words[1]); };
    const auto endsInHex = [](const Row& row) { return row.size() > 2 && isHex(row.words.back()); };
    const bool isHexFirst = areMost(rows, beginsWithHex);
    return isHexFirst || areMost(rows, endsInHex) ? decodeHex(rows, text, isHexFirst)
                                                  : decodeNames(rows);
}

}  // namespace

extern const TableCodec kRowTables{nullptr, decodeRows};

}  // namespace adaptiso::labelnames
