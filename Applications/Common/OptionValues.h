#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/RunApp.h"
#include "Common/UsageWords.h"

namespace adaptiso {

/// What a number that an option takes may be.
struct NumberRule {
    std::optional<double> least{};
    bool isAbove = false;  ///< more than `least`
    std::optional<double> most{};
    std::string unit{};  ///< "mm", "degrees"; empty: none
};

/// "a number above 0, in mm", "a number from 0 to 40, in degrees"
std::string toWords(const NumberRule& rule);

/// Refuses the value of an option: "--smooth 0,5: decimals follow a point (0.5); must be `rule`".
/// Where `text` is a number beyond what a double holds, that is said.
/// \throws UsageError
[[noreturn]] void refuseValue(const std::string& option, const std::string& text,
                              const std::string& rule);

/// The number that the value of an option is. \throws UsageError
double parseNumber(const std::string& option, const std::string& text, const NumberRule& rule);

/// The whole number from `least` to `most` that the value of an option is. A `most` of 2^53 or more
/// is not named. \throws UsageError
std::int64_t parseCount(const std::string& option, const std::string& text, std::int64_t least,
                        std::int64_t most);

inline constexpr std::int64_t kAnyCount = std::int64_t{1} << 53;

/// An option that takes a number. \param target  a double, or an optional one
template <class Target>
CLI::Option* addNumber(CLI::App& app, const std::string& name, Target& target,
                       const NumberRule& rule, const std::string& description) {
    return app.add_option_function<std::string>(
        name,
        [&target, name, rule](const std::string& text) { target = parseNumber(name, text, rule); },
        description);
}

/// An option that takes a whole number. \param target  an integer, or an optional one
template <class Target>
CLI::Option* addCount(CLI::App& app, const std::string& name, Target& target, std::int64_t least,
                      std::int64_t most, const std::string& description) {
    const auto set = [&target, name, least, most](const std::string& text) {
        const std::int64_t value = parseCount(name, text, least, most);
        if constexpr (requires { typename Target::value_type; }) {
            target = static_cast<typename Target::value_type>(value);
        } else {
            target = static_cast<Target>(value);
        }
    };
    return app.add_option_function<std::string>(name, set, description)->type_name("N");
}

/// An option that takes one of a few words, each standing for a value; `words` in the order of the
/// help text.
template <class Value, class Target>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Target& target,
                       const std::vector<std::pair<std::string, Value>>& words,
                       const std::string& description) {
    std::vector<std::string> names;
    for (const auto& [word, value] : words) names.push_back(word);
    const auto choose = [&target, words, names, name](const std::string& text) {
        const auto chosen = std::find_if(words.begin(), words.end(),
                                         [&](const auto& word) { return word.first == text; });
        if (chosen == words.end()) {
            throw UsageError(name + " " + shown(text) + ": must be " + alternatives(names) +
                             suggestion(text, names));
        }
        target = chosen->second;
    };
    return app.add_option_function<std::string>(name, choose, description)
        ->type_name(CLI::detail::join(names, "|"));
}

}  // namespace adaptiso
