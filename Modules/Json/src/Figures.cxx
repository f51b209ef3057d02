#include "adaptiso/Json/Figures.h"

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

void putFigure(Json& json, std::string_view key, Json value) {
    Json* place = &json;
    for (std::size_t dot; (dot = key.find('.')) != key.npos; key.remove_prefix(dot + 1)) {
        place = &(*place)[std::string(key.substr(0, dot))];
    }
    (*place)[std::string(key)] = std::move(value);
}

std::string figureText(const Json& value, Shown shown) {
    if (value.is_null()) return "–";
    switch (shown) {
        case Shown::No:
            break;
        case Shown::Plain:
            return value.is_string() ? value.get<std::string>() : formatNumber(value.get<double>());
        case Shown::Count:
            return formatCount(value.get<std::int64_t>());
        case Shown::Bound:
            return formatBound(value.get<double>());
        case Shown::Size:
            return formatSizeMm({value.at(0), value.at(1), value.at(2)});
        case Shown::Measure:
            return formatMeasure(value.get<double>());
    }
    throw InternalError("figureText: is not shown");
}

}  // namespace adaptiso
