#include "adaptiso/Core/TextLines.h"

#include <algorithm>

namespace adaptiso {

namespace {

constexpr std::string_view kMark = "\xEF\xBB\xBF";

}  // namespace

std::string_view withoutByteOrderMark(std::string_view bytes) {
    if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
    return bytes;
}

bool isUtf16(std::string_view bytes) {
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return true;
    constexpr std::size_t kLooked = 64;
    const std::string_view head =
        bytes.substr(0, std::min(kLooked, bytes.size() & ~std::size_t{1}));
    if (head.size() < 4) return false;
    const auto isLetter = [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); };
    for (const std::size_t high : {0, 1}) {
        bool areAll = true;
        for (std::size_t n = 0; n < head.size() && areAll; ++n) {
            areAll = n % 2 == high ? head[n] == '\0' : isLetter(head[n]);
        }
        if (areAll) return true;
    }
    return false;
}

std::string faultOfText(std::string_view bytes) {
    if (isUtf16(bytes)) return "is text in UTF-16; save it as UTF-8";
    if (bytes.find('\0') != std::string_view::npos) {
        return "holds NUL bytes, which text has none of; get it again, or save it as UTF-8";
    }
    return {};
}

std::string_view takeLine(std::string_view text, std::size_t& position) {
    const std::size_t end = std::min(text.find_first_of("\n\r", position), text.size());
    const std::string_view line = text.substr(position, end - position);
    const bool isPair = text.substr(end).starts_with("\r\n");
    position = std::min(end + (isPair ? 2 : 1), text.size());
    return line;
}

TextLines::TextLines(std::string_view text, LineEnds ends) : text_(text) {
    position_ = text.size() - withoutByteOrderMark(text).size();
    if (ends == LineEnds::Any) return;
    const std::size_t first = std::min(text.find_first_of("\n\r", position_), text.size());
    const std::size_t behind = std::min(text.find_first_not_of('\r', first), text.size());
    end_ = behind > first && !text.substr(behind).starts_with('\n') ? '\r' : '\n';
}

std::optional<std::string_view> TextLines::next() {
    if (position_ >= text_.size()) return std::nullopt;
    ++number_;
    if (end_ == 0) return takeLine(text_, position_);
    const std::size_t end = std::min(text_.find(end_, position_), text_.size());
    std::string_view line = text_.substr(position_, end - position_);
    position_ = std::min(end + 1, text_.size());
    while (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string linePlace(std::int64_t number) {
    return "line " + std::to_string(number) + ": ";
}

}  // namespace adaptiso
