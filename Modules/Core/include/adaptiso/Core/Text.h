#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// `value` as a person reads it, in at most six significant digits, in the C locale: "0.333333",
/// "1.79769e+308", "infinity", "-infinity", "not a number". Zero is "0", whatever its sign.
std::string formatShort(double value);

/// `text` with A to Z as a to z; other characters stay.
std::string lowerCase(std::string_view text);

/// `text` without the blanks (of ASCII) around it.
std::string_view trimmed(std::string_view text);

/// `text` with '?' for every byte that is not visible ASCII or a blank.
std::string visibleAscii(std::string_view text);

/// visibleAscii() in quotes, cut at 40 characters: for messages.
std::string printable(std::string_view text);

/// `text` with a blank for every character that could steer a terminal or reorder what it shows:
/// controls (C0, DEL, C1), separators of lines and the embeddings, overrides and isolates of
/// bidirectional text. All that outsiders named passes through here on its way to a person.
/// \param kept  controls that stay, such as "\n"
std::string withoutControls(std::string_view text, std::string_view kept = {});

/// `text` escaped for HTML and XML, between tags and in quotes, withoutControls().
std::string escapedMarkup(std::string_view text);

/// Base64 with padding, in one line (RFC 4648).
std::string encodeBase64(std::string_view bytes);

/// True if `text` is UTF-8 (RFC 3629).
bool isUtf8(std::string_view text);

/// `text` as UTF-8; other encodings are taken for Latin-1.
std::string toUtf8(std::string_view text);

/// Parses all of `text` as a number, in the C locale ("100", "-0.5", "+1e3"), whatever the user's.
/// \return empty if it is no number, not finite, or too large for a double
std::optional<double> parseFiniteNumber(std::string_view text);

/// The shortest decimal text that reads back as `value`, without an exponent unless the number is
/// below 1e-6 or from 1e15 on: "100000", "0.1", "-200". Zero is "0", whatever its sign.
std::string formatNumber(double value);

/// `value` with its digits in groups of three: "1,234,567".
std::string formatCount(long long value);

/// `value` to the nearest whole number, in groups of three; from 1e15 on, and for infinity and
/// NaN, as formatShort().
std::string formatRounded(double value);

/// `value` with `digits` decimals: "0.10", never "-0.00"; from 1e15 on, and for infinity and NaN,
/// as formatShort().
std::string formatFixed(double value, int digits);

/// A length in mm with `digits` decimals, in three significant digits where that would leave fewer:
/// "1.50", "0.00015", "1.41e-05"; below 1e-9 mm as formatFixed().
std::string formatLength(double value, int digits);

/// A bound, as formatLength() but never less than `value` (to 1e-9 of it), with one decimal more
/// where it would be: 0.15000763 is "0.15001".
std::string formatBound(double value, int digits = 4);

/// A size in mm: "138.3 x 175.2 x 149.5 mm", with four decimals below 1.
std::string formatSizeMm(const Vec3& mm);

/// An area or a volume: as formatRounded() from 100 on, below in three significant digits.
std::string formatMeasure(double value);

/// Like formatShort(), with more digits where different numbers would look alike: 1000000.25 and
/// 1000000.5 are "1000000.2" and "1000000.5".
std::vector<std::string> formatApart(const std::vector<double>& values);

}  // namespace adaptiso
