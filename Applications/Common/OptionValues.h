#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "Common/RunApp.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/SimplifyAims.h"

namespace adaptiso {

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

/// The place in `words` of the value of an option. \throws UsageError
std::size_t parseChoice(const std::string& option, const std::string& text,
                        const std::vector<std::string>& words);

/// "adaptive|boxes|mc", as --help names the value of an option that takes one of these words
std::string choiceName(const std::vector<std::string>& words);

/// A row as declared.
struct DeclaredRow {
    const OptionFacts* facts;
    OptionKind kind;
    OptionValue standard;
};
/// The rows that this process has declared, by name.
std::map<std::string_view, DeclaredRow>& declaredRows();

/// Options under one heading of --help, each declared in one line: names, the value's name in
/// --help, target, help text. Values are checked as they are read. A name without dashes ("INPUT")
/// is an argument.
class OptionGroup {
public:
    /// \param heading  empty: options that --help does not list
    explicit OptionGroup(CLI::App& app, std::string heading = "Options")
        : app_(app), heading_(std::move(heading)) {}

    CLI::Option* flag(const std::string& name, bool& target, const std::string& help) const;
    /// A flag that calls `take`.
    CLI::Option* flag(const std::string& name, const std::function<void()>& take,
                      const std::string& help) const;

    /// An option whose value is given to `take` as typed.
    CLI::Option* value(const std::string& name, const std::string& valueName,
                       const std::function<void(const std::string&)>& take,
                       const std::string& help) const;
    /// An option that may be given several times; `take` gets all its values. A value's name that
    /// ends in "..." lets several values follow one name.
    CLI::Option* values(const std::string& name, const std::string& valueName,
                        const std::function<void(const std::vector<std::string>&)>& take,
                        const std::string& help) const;

    /// The options of rows; what is typed is put into `owner`.
    /// \param rows  must live as long as the app
    /// \param only  names of those to take; empty: all
    template <class Owner>
    void rows(const Options<Owner>& rows, std::type_identity_t<Owner>& owner,
              const std::vector<std::string_view>& only = {}) const {
        for (const Option<Owner>& each : rows) {
            if (!only.empty() && std::ranges::find(only, each.facts.name) == only.end()) continue;
            row({&each.facts, each.kind, each.valueOf(owner)},
                [&owner, &each](const OptionValue& value) { each.put(owner, value); });
        }
    }

    /// An option, with a value or without, that is refused with a reason.
    void refused(const std::string& name, const std::string& reason) const;

    /// A text, a path, or a list of either.
    template <class Target>
    CLI::Option* text(const std::string& name, const std::string& valueName, Target& target,
                      const std::string& help) const {
        if constexpr (requires { target.push_back(typename Target::value_type()); } &&
                      !std::is_same_v<Target, std::string>) {
            return values(
                name, valueName,
                [&target](const std::vector<std::string>& texts) {
                    target.assign(texts.begin(), texts.end());
                },
                help);
        } else {
            return value(
                name, valueName, [&target](const std::string& text) { target = text; }, help);
        }
    }

    /// A number. \param target  a double, or an optional one
    template <class Target>
    CLI::Option* number(const std::string& name, const std::string& valueName, Target& target,
                        const NumberRule& rule, const std::string& help) const {
        const auto take = [&target, name, rule](const std::string& text) {
            target = parseNumber(name, text, rule);
        };
        return value(name, valueName, take, help);
    }

    /// A whole number. \param target  an integer, or an optional one
    template <class Target>
    CLI::Option* count(const std::string& name, Target& target, std::int64_t least,
                       std::int64_t most, const std::string& help) const {
        const auto take = [&target, name, least, most](const std::string& text) {
            const std::int64_t value = parseCount(name, text, least, most);
            if constexpr (requires { typename Target::value_type; }) {
                target = static_cast<typename Target::value_type>(value);
            } else {
                target = static_cast<Target>(value);
            }
        };
        return value(name, "N", take, help);
    }

    /// One of a few words, each standing for a value; `words` in the order of the help text.
    template <class Value, class Target>
    CLI::Option* choice(const std::string& name, Target& target,
                        const std::vector<std::pair<std::string, Value>>& words,
                        const std::string& help) const {
        std::vector<std::string> names;
        for (const auto& [word, value] : words) names.push_back(word);
        const auto take = [&target, words, names, name](const std::string& text) {
            target = words[parseChoice(name, text, names)].second;
        };
        return value(name, choiceName(names), take, help);
    }

private:
    /// \param take  gets the value, checked
    void row(const DeclaredRow& declared,
             const std::function<void(const OptionValue&)>& take) const;

    CLI::App& app_;
    std::string heading_;
};

/// \throws UsageError  a count and a share are given
void requireOneCount(const SimplifyAims& aims);

/// Makes an option or argument required. \return it
CLI::Option* required(CLI::Option* option);

/// Calls `check` once all options have been read.
void afterParsing(CLI::App& app, const std::function<void()>& check);

/// Whether an option or argument declared under `name` was given.
bool isGiven(const CLI::App& app, const std::string& name);
/// The names of all that were given, in the order of --help: "--iso", "FILE".
std::vector<std::string> givenOptions(const CLI::App& app);

/// Giving `first` and `second` together is refused.
void excludeEachOther(CLI::Option* first, CLI::Option* second);

}  // namespace adaptiso
