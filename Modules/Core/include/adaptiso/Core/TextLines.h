#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace adaptiso {

/// `bytes` without UTF-8's byte order mark at their start.
std::string_view withoutByteOrderMark(std::string_view bytes);

/// True for UTF-16, with its byte order mark or, of ASCII letters, without.
bool isUtf16(std::string_view bytes);

/// Why `bytes` can't be read as lines of text: "is text in UTF-16; save it as UTF-8". Empty for
/// text, in whatever 8-bit encoding.
std::string faultOfText(std::string_view bytes);

/// The line of `text` at `position`, without its end (LF, CR LF or CR), which `position` then lies
/// behind.
std::string_view takeLine(std::string_view text, std::size_t& position);

/// What ends a line beside LF and CR LF.
enum class LineEnds {
    Any,      ///< CR alone, wherever it stands
    OfFirst,  ///< CR alone if it ends the first line; for headers that binary data may follow
};

/// Walks over the lines of a text; a byte order mark is passed over. The last line needs no end.
class TextLines {
public:
    explicit TextLines(std::string_view text, LineEnds ends = LineEnds::Any);

    /// The next line without its end; empty behind the last.
    std::optional<std::string_view> next();
    /// Of the line that next() gave last, from 1.
    std::int64_t number() const { return number_; }
    /// Bytes of the text up to the next line.
    std::size_t position() const { return position_; }

private:
    std::string_view text_;
    std::size_t position_ = 0;
    std::int64_t number_ = 0;
    char end_ = 0;  ///< the one that ends lines; 0: any
};

/// "line 7: "
std::string linePlace(std::int64_t number);

}  // namespace adaptiso
