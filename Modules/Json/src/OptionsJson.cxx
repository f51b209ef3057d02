#include "adaptiso/Json/OptionsJson.h"

#include <array>

namespace adaptiso {

Json valueJson(const OptionValue& value) {
    return std::visit(
        []<class T>(const T& held) {
            if constexpr (std::is_same_v<T, std::monostate>) {
                return Json(nullptr);
            } else if constexpr (std::is_same_v<T, double>) {
                return number(held);
            } else {
                return Json(held);
            }
        },
        value);
}

OptionValue optionValue(const Json& json, OptionKind kind) {
    if (json.is_null()) return {};
    switch (kind) {
        case OptionKind::Flag:
            return json.get_ref<const Json::boolean_t&>();
        case OptionKind::Number:
            return json.get<double>();
        case OptionKind::Count:
            return static_cast<std::int64_t>(json.get_ref<const Json::number_unsigned_t&>());
        case OptionKind::Choice:
        case OptionKind::Text:
            break;
    }
    return json.get_ref<const Json::string_t&>();
}

Json factsJson(const OptionFacts& facts, OptionKind kind, const OptionValue& standard) {
    constexpr std::array kKinds{"flag", "number", "count", "choice", "text"};
    Json json{{"name", facts.name},
              {"key", facts.key},
              {"kind", kKinds[static_cast<std::size_t>(kind)]},
              {"help", helpText(facts, kind)},
              {"default", valueJson(standard)}};
    if (!facts.standard.empty()) json["standard"] = facts.standard;
    if (kind == OptionKind::Number) {
        json["rule"] = toWords(facts.rule);
        if (facts.rule.least) json[facts.rule.isAbove ? "above" : "least"] = *facts.rule.least;
        if (facts.rule.most) json["most"] = *facts.rule.most;
        if (!facts.rule.unit.empty()) json["unit"] = facts.rule.unit;
    }
    if (kind == OptionKind::Count) {
        json["rule"] = countRule(leastOf(facts.rule), mostOf(facts.rule));
        if (facts.rule.least) json["least"] = leastOf(facts.rule);
        if (facts.rule.most) json["most"] = mostOf(facts.rule);
    }
    if (kind == OptionKind::Text) json["rule"] = facts.textRule;
    if (!facts.words.empty()) json["words"] = facts.words;
    return json;
}

}  // namespace adaptiso
