#pragma once

#include <array>
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

/// True if nothing follows `line`, not even a line's end.
bool endsText(const Line& line, std::string_view text);

/// "line 7: "
std::string place(const Line& line);

/// `word` as a label. \throws FileError "line 7: the index is x, must be a whole number
/// that 64 bits with a sign hold"
std::int64_t valueOf(std::string_view word, const Line& line, char separator = ',');

/// The whole number that all of `word` is (also as "3.0", as some tables have it).
std::optional<std::int64_t> wholeNumber(std::string_view word);
/// The finite number that all of `word` is.
std::optional<double> realNumber(std::string_view word);

/// "#ff8000", "ff8000", "#f80", with opacity or without, "rgb(255, 128, 0)", or one of the common
/// names of CSS; empty for other text.
std::optional<LabelColor> parseColor(std::string_view text);

/// Red, green and blue as a table has them.
using Channels = std::array<double, 3>;

/// Collects entries; those listed twice become a warning.
class Collector {
public:
    explicit Collector(std::string format) { table_.format = std::move(format); }

    /// Names lose blanks around them and control characters.
    void add(LabelEntry entry);
    /// The same with a colour of 0 to 255, or of 0 to 1 where all of the table's are: finish()
    /// looks.
    void add(LabelEntry entry, const Channels& channels, const std::string& where);
    /// A colour is for show: one that can't be read becomes a warning.
    /// \param where  "line 7" or "label 7"
    void leaveColorOut(const std::string& where, std::string_view text);
    /// The colour that `text` is. Empty where it can't be read, and for a short form that ends the
    /// whole table though another colour is long: it may be cut off.
    std::optional<LabelColor> colorOf(std::string_view text, const std::string& where,
                                      bool endsTable);

    /// Entries by value. \param areParts  channels are 0 to 1 even if all are whole numbers
    /// \throws FileError  no entry
    LabelTable finish(bool areParts = false);

private:
    struct Raw {
        std::int64_t value;
        Channels channels;
        std::string where;
    };
    void scaleColors(bool areParts);

    LabelTable table_;
    std::map<std::int64_t, std::size_t> places_;
    std::vector<Raw> raws_;
    bool hasLongColor_ = false;
    std::int64_t repeats_ = 0, unread_ = 0;
    std::int64_t firstRepeat_ = 0;
    std::string firstUnread_;
};

/// A file as decoders take it.
struct TableFile {
    std::string_view bytes;
    std::string text;  ///< in UTF-8, without a byte order mark; empty: it is no text
    char first = 0;    ///< of the text, blanks passed over
};

/// How a family of tables is recognised and read: one at the end of each family's .cxx, all in the
/// table of LabelTable.cxx.
struct TableCodec {
    /// Null: all text that no other recognises.
    bool (*recognizes)(const TableFile& file);
    /// Throws FileError without the file's name.
    LabelTable (*decode)(const TableFile& file);
};

LabelTable decodeXml(std::string_view text);

}  // namespace adaptiso::labelnames
