#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

/// Appends `part` to a list, after `between` unless it is the first.
inline void addPart(std::string& list, std::string_view part, std::string_view between = ", ") {
    if (!list.empty()) list += between;
    list += part;
}

/// All `parts`, texts, with `between` between them.
template <class Parts>
std::string joined(const Parts& parts, std::string_view between = ", ") {
    std::string list;
    for (const auto& part : parts) addPart(list, part, between);
    return list;
}

/// The same of what `textOf` makes of each.
template <class Parts, class TextOf>
requires(!std::is_convertible_v<TextOf, std::string_view>) std::string
    joined(const Parts& parts, TextOf textOf, std::string_view between = ", ") {
    std::string list;
    for (const auto& part : parts) addPart(list, textOf(part), between);
    return list;
}

/// "1 piece", "12,718 pieces".
inline std::string counted(std::int64_t count, std::string_view one, std::string_view many) {
    return formatCount(count) + " " + std::string(count == 1 ? one : many);
}
/// "1 piece", "12,718 pieces" of "piece".
inline std::string counted(std::int64_t count, const std::string& thing) {
    return counted(count, thing, thing + "s");
}

}  // namespace adaptiso
