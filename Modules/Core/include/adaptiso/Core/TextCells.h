#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// What stands between the cells of a table, by its first line: a tab, semicolon or comma, in this
/// order; '\0' for none.
char separatorOf(std::string_view line);

/// The cells of a line without blanks around them, and without the mark that writtenCell() puts
/// first. One in double quotes may hold separators and, doubled, quotes; between tabs only a cell
/// that is quoted as a whole is. \return empty if a quote is not closed
std::optional<std::vector<std::string>> cellsOf(std::string_view line, char separator);

/// True for what programs write where there is no number: nothing, "n/a", "NA", "NaN", "-nan",
/// "1.#QNAN", "null", "none".
bool isMissing(std::string_view cell);

/// The number that all of `word` spells, whatever the locale: for std::from_chars(), with a plus,
/// with Fortran's exponent ("1.5D+02"), or as Visual C++ writes what is not finite ("-1.#IND").
/// NaN and infinity are numbers here.
std::optional<double> parseReal(std::string_view word);

/// The number in a cell of a table: NaN where it is missing, with a decimal comma ("12,5") where
/// `separator` is no comma. \return empty if it is no number
std::optional<double> cellNumber(std::string_view cell, char separator);

/// `text` as a cell of a table with tabs: control characters become blanks, an empty one "n/a". A
/// spreadsheet would take text that begins with = + - or @ for a formula, so an apostrophe comes
/// before it unless it is a number. cellsOf() takes that away.
std::string writtenCell(std::string_view text);

}  // namespace adaptiso
