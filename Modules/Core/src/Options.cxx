#include "adaptiso/Core/Options.h"

#include "adaptiso/Core/Text.h"

namespace adaptiso {

bool NumberRule::allows(double value) const {
    return (!least || value >= *least) && (!isAbove || value > *least) && (!most || value <= *most);
}

std::string toWords(const NumberRule& rule) {
    std::string text = "a number";
    if (rule.least && rule.isAbove) text += " above " + formatNumber(*rule.least);
    if (rule.least && rule.most && !rule.isAbove) {
        text += " from " + formatNumber(*rule.least) + " to " + formatNumber(*rule.most);
    } else if (rule.least && !rule.isAbove) {
        text += ", " + formatNumber(*rule.least) + " or more";
    } else if (rule.most) {
        text += ", at most " + formatNumber(*rule.most);
    }
    if (!rule.least && !rule.most) text = "a finite number";
    return rule.unit.empty() ? text : text + ", in " + std::string(rule.unit);
}

std::string countRule(std::int64_t least, std::int64_t most) {
    const std::string first = std::to_string(least);
    return "a whole number" + (most < kAnyCount ? " from " + first + " to " + std::to_string(most)
                                                : ", " + first + " or more");
}

std::int64_t leastOf(const NumberRule& rule) {
    return static_cast<std::int64_t>(rule.least.value_or(0));
}

std::int64_t mostOf(const NumberRule& rule) {
    return rule.most ? static_cast<std::int64_t>(*rule.most) : kAnyCount;
}

std::string valueText(const OptionValue& value, const NumberRule& rule) {
    if (const bool* isSet = std::get_if<bool>(&value)) return *isSet ? "yes" : "no";
    if (const std::int64_t* count = std::get_if<std::int64_t>(&value)) return formatCount(*count);
    if (const std::string* text = std::get_if<std::string>(&value)) return *text;
    if (const double* number = std::get_if<double>(&value)) {
        if (rule.unit == "degrees") return formatNumber(*number) + "°";
        return formatNumber(*number) + (rule.unit.empty() ? "" : " ") + std::string(rule.unit);
    }
    return "none";
}

std::string helpText(const OptionFacts& facts, OptionKind kind) {
    std::string aside;
    if (kind == OptionKind::Number) aside = toWords(facts.rule);
    if (!facts.standard.empty()) {
        aside += (aside.empty() ? "default: " : "; default: ") + std::string(facts.standard);
    }
    return std::string(facts.help) + (aside.empty() ? "" : " (" + aside + ")");
}

}  // namespace adaptiso
