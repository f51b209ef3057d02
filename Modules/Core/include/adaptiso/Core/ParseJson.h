#pragma once

#include <string_view>

namespace adaptiso {

/// True if lists and objects are nested deeper than in any JSON that is written on purpose.
bool isDeeplyNested(std::string_view json);

/// Parses a text from outside. What copies, writes and removes JSON calls itself for each level, so
/// that deep nesting would end the program.
/// \tparam Json  nlohmann's, ordered or not
/// \return discarded (Json::is_discarded) where `text` is no JSON or isDeeplyNested()
template <class Json>
Json parseJson(std::string_view text) {
    if (isDeeplyNested(text)) return Json(Json::value_t::discarded);
    return Json::parse(text, nullptr, false);
}

}  // namespace adaptiso
