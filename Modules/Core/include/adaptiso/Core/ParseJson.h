#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// True if lists and objects are nested deeper than in any JSON that is written on purpose.
bool isDeeplyNested(std::string_view json);

/// Parses a text from outside. What copies, writes and removes JSON calls itself for each level, so
/// that deep nesting would end the program.
/// \tparam Json  nlohmann's, ordered or not
/// \return discarded (Json::is_discarded) where `text` is no JSON, isDeeplyNested(), or an object
///         has a key twice, of which programs take different ones
template <class Json>
Json parseJson(std::string_view text) {
    if (isDeeplyNested(text)) return Json(Json::value_t::discarded);
    std::vector<std::set<std::string>> keys;  // of the objects that are open
    bool isTwice = false;
    const auto look = [&](int, auto event, Json& key) {
        using Event = decltype(event);
        if (event == Event::object_start) keys.emplace_back();
        if (event == Event::object_end) keys.pop_back();
        if (event == Event::key) {
            const bool isNew = keys.back().insert(key.template get<std::string>()).second;
            isTwice = isTwice || !isNew;
        }
        return true;
    };
    Json json = Json::parse(text, look, false);
    return isTwice ? Json(Json::value_t::discarded) : json;
}

/// The whole number that `json` is. get() of one with a decimal point or an exponent is undefined
/// where the type can't hold it.
/// \throws Json::exception  it is another value
template <class Integer, class Json>
Integer wholeNumber(const Json& json) {
    using Unsigned = typename Json::number_unsigned_t;
    using Signed = typename Json::number_integer_t;
    return json.is_number_unsigned()
               ? static_cast<Integer>(json.template get_ref<const Unsigned&>())
               : static_cast<Integer>(json.template get_ref<const Signed&>());
}

}  // namespace adaptiso
