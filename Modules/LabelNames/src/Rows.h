#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Text.h"
#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso::labelnames {

/// Fails with FileError "<what>; the table is damaged: mend or replace it". decodeLabelTable() puts
/// the file's name in front.
[[noreturn]] void damaged(const std::string& what);

/// \throws NoLabelTable, without the file's name
[[noreturn]] void refuseKind(const std::string& why);

/// A line that is neither empty nor a comment.
struct Line {
    std::int64_t number = 0;  ///< from 1
    std::string_view text;    ///< without the line's end
};

/// The lines of a text; those that begin with # are left out.
std::vector<Line> linesOf(std::string_view text);

/// "line 7: "
std::string place(const Line& line);

/// `word` as a label. \throws FileError "line 7: the index is x, must be a whole number
/// that 32 bits hold"
std::int32_t valueOf(std::string_view word, const Line& line);

/// The whole number that all of `word` is (also as "3.0", as some tables have it).
std::optional<std::int64_t> wholeNumber(std::string_view word);
/// The finite number that all of `word` is.
std::optional<double> realNumber(std::string_view word);

/// Red, green or blue, 0 to 255. \throws FileError naming the line
std::uint8_t channelOf(std::string_view word, const Line& line);

/// "#ff8000" or "ff8000"; empty for other text.
std::optional<LabelColor> parseHex(std::string_view text);

/// Collects entries; those listed twice become a warning.
class Collector {
public:
    explicit Collector(std::string format) { table_.format = std::move(format); }

    /// Names lose blanks around them and control characters.
    void add(LabelEntry entry);

    /// Entries by value. \throws FileError  no entry
    LabelTable finish();

private:
    LabelTable table_;
    std::map<std::int32_t, std::size_t> places_;
    std::int64_t repeats_ = 0;
    std::int32_t firstRepeat_ = 0;
};

// One a family of formats. They throw FileError without the file's name.
LabelTable decodeDelimited(std::string_view text);  ///< one separator between fields
LabelTable decodeSpaced(std::string_view text);     ///< words with blanks between
LabelTable decodeXml(std::string_view text);
LabelTable decodeJson(std::string_view text);

/// True if the first line of `text` has fields with a separator between them.
bool isDelimited(std::string_view text);

}  // namespace adaptiso::labelnames
