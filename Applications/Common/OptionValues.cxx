#include "Common/OptionValues.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

/// "10,000", "-1,234,567": commas after each three digits.
bool hasThousands(std::string_view text) {
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos || comma == 0 || comma > 3 || text[0] == '0') return false;
    for (std::size_t n = 0; n < text.size(); ++n) {
        const bool isComma = n >= comma && (n - comma) % 4 == 0;
        if (isComma ? text[n] != ',' : text[n] < '0' || text[n] > '9') return false;
    }
    return (text.size() - comma) % 4 == 0;
}

/// \pre hasThousands(text)
std::string causeOfThousands(const std::string& text) {
    std::string without = text, withPoint = text;
    const auto commas = std::erase(without, ',');
    std::replace(withPoint.begin(), withPoint.end(), ',', '.');
    return (commas == 1 ? "has a comma" : "has commas") +
           (": thousands are written without (" + without + ")") +
           (commas == 1 ? ", decimals with a point (" + withPoint + ")" : "");
}

/// Why `text` is no finite number where that is not plain to see; else empty.
std::string causeOf(const std::string& text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc::result_out_of_range && last == end) {
        const std::size_t exponent = text.find_first_of("eE");
        const bool isTiny = exponent != std::string::npos && text[exponent + 1] == '-';
        return isTiny ? "is too close to 0 for a number here"
                      : "is larger than the largest number there is here, 1.8e308";
    }
    if (hasThousands(text)) return causeOfThousands(text);
    std::string withPoint = text;
    std::replace(withPoint.begin(), withPoint.end(), ',', '.');
    if (withPoint != text && parseFiniteNumber(withPoint)) {
        return "decimals follow a point (" + withPoint + ")";
    }
    return "";
}

/// "; 50 % is 0.5", of a percentage where a share is wanted; else empty.
std::string shareOf(std::string text, const NumberRule& rule) {
    constexpr double kWhole = 100;
    if (text.ends_with('%')) text.pop_back();
    const std::optional<double> value = parseFiniteNumber(text);
    if (!value || rule.least != 0 || rule.most != 1 || !(*value > 1 && *value <= kWhole)) return "";
    return "; " + text + " % is " + formatShort(*value / kWhole);
}

}  // namespace

void refuseValue(const std::string& option, const std::string& text, const std::string& rule) {
    const std::string cause = causeOf(text);
    throw UsageError(option + " " + shown(text) + ": " + cause + (cause.empty() ? "" : "; ") +
                     "must be " + rule);
}

double parseNumber(const std::string& option, const std::string& text, const NumberRule& rule) {
    const std::optional<double> value = parseFiniteNumber(text);
    if (!value || !rule.allows(*value))
        refuseValue(option, text, toWords(rule) + shareOf(text, rule));
    return *value;
}

std::int64_t parseCount(const std::string& option, const std::string& text, std::int64_t least,
                        std::int64_t most) {
    std::string_view digits = text;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    std::int64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [last, error] = std::from_chars(digits.data(), end, value);
    if (error == std::errc{} && last == end && value >= least && value <= most) return value;
    refuseValue(option, text, countRule(least, most));
}

std::size_t parseChoice(const std::string& option, const std::string& text,
                        const std::vector<std::string>& words) {
    const auto chosen = std::find(words.begin(), words.end(), text);
    if (chosen == words.end()) {
        throw UsageError(option + " " + shown(text) + ": must be " + alternatives(words) +
                         suggestion(text, words));
    }
    return static_cast<std::size_t>(chosen - words.begin());
}

std::string choiceName(const std::vector<std::string>& words) {
    return CLI::detail::join(words, "|");
}

CLI::Option* OptionGroup::flag(const std::string& name, bool& target,
                               const std::string& help) const {
    return app_.add_flag(name, target, help)->group(heading_);
}

CLI::Option* OptionGroup::flag(const std::string& name, const std::function<void()>& take,
                               const std::string& help) const {
    return app_.add_flag_callback(name, take, help)->group(heading_);
}

CLI::Option* OptionGroup::value(const std::string& name, const std::string& valueName,
                                const std::function<void(const std::string&)>& take,
                                const std::string& help) const {
    return app_.add_option_function<std::string>(name, take, help)
        ->type_name(valueName)
        ->group(heading_);
}

CLI::Option* OptionGroup::values(const std::string& name, const std::string& valueName,
                                 const std::function<void(const std::vector<std::string>&)>& take,
                                 const std::string& help) const {
    return app_.add_option_function<std::vector<std::string>>(name, take, help)
        ->type_name(valueName)
        ->allow_extra_args(valueName.ends_with("...") || !name.starts_with('-'))
        ->group(heading_);
}

std::map<std::string_view, DeclaredRow>& declaredRows() {
    static std::map<std::string_view, DeclaredRow> rows;
    return rows;
}

void OptionGroup::row(const DeclaredRow& declared,
                      const std::function<void(const OptionValue&)>& take) const {
    const OptionFacts& facts = *declared.facts;
    const OptionKind kind = declared.kind;
    declaredRows()[facts.name] = declared;
    const std::string name = "--" + std::string(facts.name), help = helpText(facts, kind);
    if (kind == OptionKind::Flag) {
        flag(
            name, [take] { take(true); }, help);
        return;
    }
    const std::vector<std::string> words(facts.words.begin(), facts.words.end());
    const auto read = [=](const std::string& text) {
        if (kind == OptionKind::Number) {
            take(parseNumber(name, text, facts.rule));
        } else if (kind == OptionKind::Count) {
            take(parseCount(name, text, leastOf(facts.rule), mostOf(facts.rule)));
        } else if (kind == OptionKind::Choice) {
            take(words[parseChoice(name, text, words)]);
        } else if (facts.isUsable == nullptr || facts.isUsable(text)) {
            take(text);
        } else {
            throw UsageError(name + " " + shown(text) + ": must be " + std::string(facts.textRule));
        }
    };
    value(name, words.empty() ? std::string(facts.valueName) : choiceName(words), read, help);
}

void OptionGroup::refused(const std::string& name, const std::string& reason) const {
    const auto refuse = [reason](const std::vector<std::string>&) { throw UsageError(reason); };
    app_.add_option_function<std::vector<std::string>>(name, refuse)
        ->expected(0, 1)
        ->group(heading_);
}

void requireOneCount(const SimplifyAims& aims) {
    if (!aims.maxTriangles || !aims.reduction) return;
    throw UsageError("--triangles and --reduction: are two ways to ask for one count");
}

CLI::Option* required(CLI::Option* option) {
    return option->required();
}

void afterParsing(CLI::App& app, const std::function<void()>& check) {
    app.callback(check);
}

bool isGiven(const CLI::App& app, const std::string& name) {
    return app.get_option(name)->count() > 0;
}

std::vector<std::string> givenOptions(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() > 0) names.push_back(option->get_name(option->get_lnames().empty()));
    }
    return names;
}

void excludeEachOther(CLI::Option* first, CLI::Option* second) {
    first->excludes(second);
}

}  // namespace adaptiso
