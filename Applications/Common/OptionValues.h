#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/CliNames.h"

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

/// An option whose value is given to `take` as typed.
/// \param valueName  what --help calls the value; empty: TEXT
CLI::Option* addValue(CLI::App& app, const std::string& name, const std::string& valueName,
                      const std::function<void(const std::string&)>& take,
                      const std::string& description);

/// An option that may be given several times; all its values are given to `take`, as typed.
CLI::Option* addValues(CLI::App& app, const std::string& name, const std::string& valueName,
                       const std::function<void(const std::vector<std::string>&)>& take,
                       const std::string& description);

/// An option that takes a number. \param target  a double, or an optional one
template <class Target>
CLI::Option* addNumber(CLI::App& app, const std::string& name, Target& target,
                       const NumberRule& rule, const std::string& description) {
    return addValue(
        app, name, "",
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
    return addValue(app, name, "N", set, description);
}

/// The place in `words` of the value of an option. \throws UsageError
std::size_t parseChoice(const std::string& option, const std::string& text,
                        const std::vector<std::string>& words);

/// "adaptive|boxes|mc", as --help names the value of an option that takes one of these words
std::string choiceName(const std::vector<std::string>& words);

/// An option that takes one of a few words, each standing for a value; `words` in the order of the
/// help text.
template <class Value, class Target>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Target& target,
                       const std::vector<std::pair<std::string, Value>>& words,
                       const std::string& description) {
    std::vector<std::string> names;
    for (const auto& [word, value] : words) names.push_back(word);
    const auto choose = [&target, words, names, name](const std::string& text) {
        target = words[parseChoice(name, text, names)].second;
    };
    return addValue(app, name, choiceName(names), choose, description);
}

}  // namespace adaptiso
