#include "HeaderText.h"

#include <algorithm>
#include <charconv>

#include "ByteSource.h"
#include "FileFault.h"
#include "adaptiso/Core/TextCells.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

template <class T>
std::optional<T> parseAll(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> found;
    for (text = trimmed(text); !text.empty();) {
        const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
        found.push_back(text.substr(0, end));
        text = trimmed(text.substr(end));
    }
    return found;
}

bool isSpatialKind(std::string_view kind) {
    return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
}

std::optional<double> parseNumber(std::string_view text) {
    return parseReal(trimmed(text));
}

std::optional<std::int64_t> parseInteger(std::string_view text) {
    return parseAll<std::int64_t>(text);
}

template <class T>
std::optional<T> parseNumberAs(std::string_view text) {
    return parseAll<T>(text);
}
template std::optional<std::int8_t> parseNumberAs(std::string_view);
template std::optional<std::uint8_t> parseNumberAs(std::string_view);
template std::optional<std::int16_t> parseNumberAs(std::string_view);
template std::optional<std::uint16_t> parseNumberAs(std::string_view);
template std::optional<std::int32_t> parseNumberAs(std::string_view);
template std::optional<std::uint32_t> parseNumberAs(std::string_view);
template std::optional<std::int64_t> parseNumberAs(std::string_view);
template std::optional<std::uint64_t> parseNumberAs(std::string_view);

std::string readHead(const fs::path& file, std::size_t most) {
    std::string head(std::min<std::uint64_t>(most, requireRegularFile(file)), '\0');
    head.resize(ByteSource(file, 0, ByteSource::Encoding::Raw).readSome(head.data(), head.size()));
    return head;
}

}  // namespace adaptiso::detail
