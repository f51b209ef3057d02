#pragma once

#include <string>
#include <string_view>

namespace adaptiso {

/// `value` as a person reads it, in at most six significant digits, in the C locale: "0.333333",
/// "1.79769e+308", "infinity", "-infinity", "not a number". Zero is "0", whatever its sign.
std::string shortText(double value);

/// `text` with A to Z as a to z; other characters stay.
std::string lowerCase(std::string_view text);

/// `text` without the blanks (of ASCII) around it.
std::string_view trimmed(std::string_view text);

/// `text` as HTML and XML have it between tags and in quotes; control characters become blanks.
std::string escapedMarkup(std::string_view text);

/// Base64 with padding, in one line (RFC 4648).
std::string encodeBase64(std::string_view bytes);

/// Whether `text` is UTF-8 as RFC 3629 has it.
bool isUtf8(std::string_view text);

/// `text` as UTF-8: text that is not is taken for Latin-1.
std::string toUtf8(std::string_view text);

}  // namespace adaptiso
