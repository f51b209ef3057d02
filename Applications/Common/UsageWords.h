#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "Common/RunApp.h"

namespace adaptiso {

/// A value of an option as messages show it: in quotes where it is empty or holds blanks or control
/// characters, cut off where it is long.
std::string shown(std::string_view text);

/// The word that `typed` is a slip of the keyboard for: one letter off in words of up to four, two
/// off in up to eight, three off in longer ones (a swap of neighbours is one), or one of the two
/// begins with the other (three letters or more). Of words more than one letter off the first
/// letter is right. The nearest, of equals the first; none when all are farther.
std::optional<std::string> nearestWord(std::string_view typed,
                                       const std::vector<std::string>& words);

/// "; did you mean adaptive?", or nothing
std::string suggestion(std::string_view typed, const std::vector<std::string>& words);

/// "adaptive, boxes or mc"
std::string alternatives(const std::vector<std::string>& words);

/// True for a dash and a letter: "-o".
bool isLetterOption(std::string_view word);

/// Refuses an option whose value is missing, empty or the name of another option, "--flag=value",
/// and an empty argument. The parser would take the next word for the value. \throws UsageError
/// \pre all options are declared
void refuseMisplacedValues(const CLI::App& app, int argc, const char* const* argv);

/// Refuses the name of an output, the value of `option`, that holds a placeholder ("{iso}") which
/// is none of `known`. \throws UsageError
void requirePlaceholders(const std::string& option, const std::filesystem::path& output,
                         const std::vector<std::string>& known);

/// The message for a parse error: one line that names the option and says what to do.
std::string inWords(const CLI::App& app, const CLI::ParseError& error);

}  // namespace adaptiso
