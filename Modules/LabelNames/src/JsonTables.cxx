// Label tables in JSON: by value, as a list, or as niivue has them.
#include <cmath>
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

/// Three numbers, or four with opacity: 0 to 255, or 0 to 1 where none of them is above 1 and one
/// is no whole number or all are at most 1.
LabelColor colorOf(const std::vector<double>& parts, std::int32_t key) {
    LabelColor color{};
    bool areParts = true;
    for (std::size_t n = 0; n < 3; ++n) {
        if (!(parts[n] >= 0 && parts[n] <= 255)) {
            damaged("the colour of label " + std::to_string(key) + " is not within 0 to 255");
        }
        areParts = areParts && parts[n] <= 1;
    }
    for (std::size_t n = 0; n < 3; ++n) {
        color[n] = static_cast<std::uint8_t>(std::lround(areParts ? 255 * parts[n] : parts[n]));
    }
    return color;
}

std::vector<double> numbersOf(const Json& list) {
    std::vector<double> numbers;
    for (const Json& each : list) {
        if (!each.is_number()) damaged("a colour holds something that is no number");
        numbers.push_back(each.get<double>());
    }
    return numbers;
}

std::optional<LabelColor> colorOf(const Json& object, std::int32_t key) {
    const Json* color = member(
        object, {"color", "colour", "rgb", "rgba", "rgb_triplet", "hex", "color_hex_triplet"});
    if (color != nullptr && color->is_string()) {
        const std::optional<LabelColor> parsed = parseHex(color->get<std::string>());
        if (!parsed) {
            damaged("the colour of label " + std::to_string(key) + " is " +
                    printable(color->get<std::string>()) + ", must be #RRGGBB");
        }
        return parsed;
    }
    if (color != nullptr && color->is_array() && (color->size() == 3 || color->size() == 4)) {
        return colorOf(numbersOf(*color), key);
    }
    const Json* const red = member(object, {"red", "Red", "r", "R"});
    const Json* const green = member(object, {"green", "Green", "g", "G"});
    const Json* const blue = member(object, {"blue", "Blue", "b", "B"});
    if (red == nullptr || green == nullptr || blue == nullptr) return std::nullopt;
    return colorOf(numbersOf(Json::array({*red, *green, *blue})), key);
}

LabelEntry entryOf(std::int32_t key, const Json& json) {
    LabelEntry entry;
    entry.value = key;
    if (json.is_string()) {
        entry.name = json.get<std::string>();
        return entry;
    }
    if (!json.is_object()) damaged("label " + std::to_string(key) + " has no name");
    entry.name = textOf(member(json, {"name", "Name", "label", "Label", "text"}));
    entry.abbreviation = textOf(member(json, {"abbreviation", "acronym"}));
    entry.color = colorOf(json, key);
    return entry;
}

LabelTable decodeList(const Json& list) {
    Collector found("JSON");
    for (const Json& each : list) {
        const Json* const key =
            each.is_object() ? member(each, {"index", "key", "Key", "value", "id", "labelValue"})
                             : nullptr;
        if (key == nullptr) refuseKind("its list holds something without an index");
        found.add(entryOf(keyOf(*key), each));
    }
    return found.finish();
}

LabelTable decodeByValue(const Json& object) {
    Collector found("JSON");
    for (const auto& [key, each] : object.items()) found.add(entryOf(keyOf(Json(key)), each));
    return found.finish();
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
        LabelColor color{};
        constexpr const char* kChannels[] = {"R", "G", "B"};
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = numbersOf(Json::array({list(kChannels[c])[n]})).front();
            if (!(value >= 0 && value <= 255)) {
                damaged("a colour is not within 0 to 255");
            }
            color[c] = static_cast<std::uint8_t>(std::lround(value));
        }
        entry.color = color;
        found.add(std::move(entry));
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

}  // namespace

LabelTable decodeJson(std::string_view text) {
    const Json json = parseJson<Json>(text);
    if (json.is_discarded()) refuseKind("its JSON is damaged");
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

}  // namespace adaptiso::labelnames
