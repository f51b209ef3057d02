// Label tables in JSON: by value, as a list, or as niivue has them.
#include <nlohmann/json.hpp>

#include "Rows.h"
#include "adaptiso/Core/ParseJson.h"

namespace adaptiso::labelnames {
namespace {

using Json = nlohmann::json;

/// The first of `names` that `object` has; null where it has none.
const Json* member(const Json& object, std::initializer_list<const char*> names) {
    for (const char* const name : names) {
        const auto at = object.find(name);
        if (at != object.end() && !at->is_null()) return &*at;
    }
    return nullptr;
}

std::int32_t keyOf(const Json& json) {
    const std::string text = json.is_string()       ? json.get<std::string>()
                             : json.is_structured() ? "a list"
                                                    : json.dump();
    const std::optional<std::int64_t> value = wholeNumber(text);
    constexpr std::int64_t kMost = (std::int64_t{1} << 31) - 1;
    if (!value || *value < -kMost || *value > kMost) {
        damaged("an index is " + printable(text) + ", must be a whole number that 32 bits hold");
    }
    return static_cast<std::int32_t>(*value);
}

std::string textOf(const Json* json) {
    return json != nullptr && json->is_string() ? json->get<std::string>() : std::string();
}

/// The numbers of a colour: three, or four with opacity. Empty for anything else.
std::optional<Channels> channelsOf(std::initializer_list<const Json*> numbers) {
    Channels channels{};
    std::size_t n = 0;
    for (const Json* const number : numbers) {
        if (number == nullptr || !number->is_number()) return std::nullopt;
        channels[n++] = number->get<double>();
    }
    return channels;
}

void addEntry(Collector& found, std::int32_t key, const Json& json) {
    LabelEntry entry;
    entry.value = key;
    if (json.is_string()) {
        entry.name = json.get<std::string>();
        return found.add(std::move(entry));
    }
    if (!json.is_object()) damaged("label " + std::to_string(key) + " has no name");
    entry.name = textOf(member(json, {"name", "Name", "label", "Label", "text"}));
    entry.abbreviation = textOf(member(json, {"abbreviation", "acronym"}));
    const Json* color =
        member(json, {"color", "colour", "rgb", "rgba", "rgb_triplet", "hex", "color_hex_triplet"});
    std::optional<Channels> channels = channelsOf({member(json, {"red", "Red", "r", "R"}),
                                                   member(json, {"green", "Green", "g", "G"}),
                                                   member(json, {"blue", "Blue", "b", "B"})});
    if (color != nullptr && color->is_array() && (color->size() == 3 || color->size() == 4)) {
        channels = channelsOf({&(*color)[0], &(*color)[1], &(*color)[2]});
    } else if (color != nullptr) {
        const std::string text = textOf(color);
        entry.color = parseColor(text);
        if (entry.color) return found.add(std::move(entry));
    }
    const std::string where = "label " + std::to_string(key);
    if (channels) return found.add(std::move(entry), *channels, where);
    if (color != nullptr) {
        found.leaveColorOut(where,
                            color->is_string() ? color->get<std::string>() : "no text or numbers");
    }
    found.add(std::move(entry));
}

LabelTable decodeList(const Json& list) {
    Collector found("JSON");
    for (const Json& each : list) {
        const Json* const key =
            each.is_object() ? member(each, {"index", "key", "Key", "value", "id", "labelValue"})
                             : nullptr;
        if (key == nullptr) refuseKind("its list holds something without an index");
        addEntry(found, keyOf(*key), each);
    }
    return found.finish(true);
}

LabelTable decodeByValue(const Json& object) {
    Collector found("JSON");
    for (const auto& [key, each] : object.items()) addEntry(found, keyOf(Json(key)), each);
    return found.finish(true);
}

/// Lists of reds, greens, blues, values and names.
LabelTable decodeNiivue(const Json& json) {
    Collector found("niivue");
    const auto list = [&](const char* name) -> const Json& {
        const Json* const values = member(json, {name});
        if (values == nullptr || !values->is_array()) {
            damaged("it has no list " + std::string(name));
        }
        return *values;
    };
    const Json& names = list("labels");
    const bool hasIndices = json.contains("I");
    for (const char* const other : {"R", "G", "B"}) {
        if (list(other).size() != names.size()) {
            damaged("it has " + std::to_string(list(other).size()) + " values of " + other +
                    " for " + std::to_string(names.size()) + " labels");
        }
    }
    if (hasIndices && list("I").size() != names.size()) {
        damaged("it has " + std::to_string(list("I").size()) + " values of I for " +
                std::to_string(names.size()) + " labels");
    }
    for (std::size_t n = 0; n < names.size(); ++n) {
        LabelEntry entry;
        entry.value = hasIndices ? keyOf(list("I")[n]) : static_cast<std::int32_t>(n);
        entry.name = textOf(&names[n]);
        const auto channels = channelsOf({&list("R")[n], &list("G")[n], &list("B")[n]});
        if (channels) {
            const std::string where = "label " + std::to_string(entry.value);
            found.add(std::move(entry), *channels, where);
        } else {
            found.leaveColorOut("label " + std::to_string(entry.value), "no numbers");
            found.add(std::move(entry));
        }
    }
    return found.finish();
}

bool isByValue(const Json& object) {
    if (object.empty()) return false;
    for (const auto& [key, value] : object.items()) {
        if (!wholeNumber(key)) return false;
    }
    return true;
}

LabelTable decodeJson(const TableFile& file) {
    const Json json = parseJson<Json>(file.text);
    if (json.is_discarded()) refuseKind("its JSON is damaged, or has a key twice");
    if (json.is_array() && !json.empty()) return decodeList(json);
    if (json.is_object()) {
        if (json.contains("labels") && json.contains("R")) return decodeNiivue(json);
        if (isByValue(json)) return decodeByValue(json);
        for (const char* const name : {"labels", "LabelTable", "labelTable", "structures"}) {
            const auto inner = json.find(name);
            if (inner == json.end()) continue;
            if (inner->is_array() && !inner->empty()) return decodeList(*inner);
            if (inner->is_object() && isByValue(*inner)) return decodeByValue(*inner);
        }
    }
    refuseKind("its JSON is neither a list of labels nor names by value");
}

bool isJson(const TableFile& file) {
    return file.first == '{' || file.first == '[';
}

}  // namespace

extern const TableCodec kJsonTables{isJson, decodeJson};

}  // namespace adaptiso::labelnames
