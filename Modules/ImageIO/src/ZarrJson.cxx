#include "ZarrJson.h"

#include <fmt/core.h>

#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

std::optional<ZarrJson> readZarrJson(const ZarrStore& store, const std::string& key) {
    const std::optional<std::string> text = store.readText(key);
    if (!text) return std::nullopt;
    // writers of Python put NaN into fill_value as a bare word, which JSON has not
    ZarrJson json = ZarrJson::parse(*text, nullptr, false);
    if (json.is_discarded() || !json.is_object()) {
        refuse(store.root() / key, "is damaged: it is no JSON object", "get the dataset again");
    }
    return json;
}

const ZarrJson& memberOf(const ZarrJson& object, const char* key) {
    static const ZarrJson kNone;
    if (!object.is_object()) return kNone;
    const auto found = object.find(key);
    return found == object.end() ? kNone : *found;
}

std::string shownJson(const ZarrJson& value) {
    if (value.is_array()) return "[...]";
    if (value.is_object()) return "{...}";
    return printable(value.dump(-1, ' ', true, ZarrJson::error_handler_t::replace));
}

std::string textOf(const fs::path& file, const ZarrJson& object, const char* key) {
    const ZarrJson& value = memberOf(object, key);
    if (!value.is_string()) {
        refuse(file, fmt::format("its metadata are damaged: no {}", key), "repair them");
    }
    return value.get<std::string>();
}

std::vector<std::uint64_t> numbersOf(const fs::path& file, const ZarrJson& object, const char* key,
                                     std::uint64_t least) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 48;
    const ZarrJson& list = memberOf(object, key);
    std::vector<std::uint64_t> numbers;
    if (list.is_array()) {
        for (const ZarrJson& value : list) {
            if (!value.is_number_unsigned()) break;
            numbers.push_back(value.get<std::uint64_t>());
            if (numbers.back() < least || numbers.back() > kMost) numbers.clear();
            if (numbers.empty()) break;
        }
    }
    if (numbers.empty() || numbers.size() != list.size()) {
        refuse(file,
               fmt::format("its metadata are damaged: {} is no list of whole numbers from {} on",
                           key, least),
               "repair them");
    }
    return numbers;
}

}  // namespace adaptiso::detail
