#include "ByteSource.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::meshio {
namespace {

constexpr bool isSpace(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f';
}

template <class T>
T parsed(std::string_view word, std::string_view what, std::string_view kind) {
    T value{};
    std::string_view digits = word;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc() || stop != end) {
        damaged(std::string(what) + " is " + printable(word) + ", must be " + std::string(kind));
    }
    return value;
}

}  // namespace

void damaged(const std::string& what) {
    throw FileError(what + "; the file is cut off, damaged or not what its name says: replace it");
}

void unsupported(const std::string& what, const std::string& advice) {
    throw FileError(what + "; " + advice);
}

void requireRoom(std::string_view what, std::int64_t count, std::int64_t bytesEach,
                 std::size_t bytesLeft) {
    if (count < 0 || static_cast<std::uint64_t>(count) > bytesLeft / bytesEach) {
        damaged("it says it holds " + std::to_string(count) + " " + std::string(what) +
                ", but only " + std::to_string(bytesLeft) + " bytes are left for them");
    }
}

std::string_view ByteSource::take(std::size_t count) {
    if (count > left()) {
        damaged("it ends after " + std::to_string(bytes_.size()) + " bytes, where " +
                std::to_string(count - left()) + " more are due");
    }
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
}

std::string_view ByteSource::line() {
    const std::size_t end = std::min(bytes_.find('\n', position_), bytes_.size());
    std::string_view text = bytes_.substr(position_, end - position_);
    position_ = std::min(end + 1, bytes_.size());
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
}

std::string_view ByteSource::word() {
    while (position_ < bytes_.size() && isSpace(bytes_[position_])) ++position_;
    const std::size_t begin = position_;
    while (position_ < bytes_.size() && !isSpace(bytes_[position_])) ++position_;
    return bytes_.substr(begin, position_ - begin);
}

std::string_view ByteSource::requireWord(std::string_view what) {
    const std::string_view found = word();
    if (found.empty()) damaged("it ends where " + std::string(what) + " is due");
    return found;
}

std::int64_t ByteSource::integerWord(std::string_view what) {
    return toInteger(requireWord(what), what);
}

double ByteSource::realWord(std::string_view what) {
    return toReal(requireWord(what), what);
}

std::int64_t toInteger(std::string_view word, std::string_view what) {
    return parsed<std::int64_t>(word, what, "a whole number");
}

double toReal(std::string_view word, std::string_view what) {
    return parsed<double>(word, what, "a number");
}

float toFloat(double value, std::string_view what) {
    if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) {
        damaged(std::string(what) + " is " + std::to_string(value) + ", too large for float");
    }
    return static_cast<float>(value);
}

std::string printable(std::string_view text) {
    std::string shown(text.substr(0, 40));
    for (char& c : shown) {
        if (c < ' ' || c > '~') c = '?';
    }
    return "'" + shown + (text.size() > 40 ? "...'" : "'");
}

}  // namespace adaptiso::meshio
