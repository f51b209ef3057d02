#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace adaptiso {

/// The range of a number.
struct NumberRule {
    std::optional<double> least{};
    bool isAbove = false;  ///< more than `least`
    std::optional<double> most{};
    std::string_view unit{};  ///< "mm", "degrees"; empty: none

    bool allows(double value) const;
};

/// "a number above 0, in mm", "a number from 0 to 40, in degrees"
std::string toWords(const NumberRule& rule);

/// Counts have no upper limit from here on.
inline constexpr std::int64_t kAnyCount = std::int64_t{1} << 53;

/// "a whole number from 0 to 3", "a whole number, 0 or more"
std::string countRule(std::int64_t least, std::int64_t most);

/// The smallest and the largest count that a rule allows.
std::int64_t leastOf(const NumberRule& rule);
std::int64_t mostOf(const NumberRule& rule);

/// Facts about one option, from which the command line, --help, reports and Python's arguments are
/// made.
struct OptionFacts {
    std::string_view name;         ///< "max-error": --max-error, Python's max_error
    std::string_view key{};        ///< in reports: "maxErrorMm"
    std::string_view label{};      ///< on pages: "Largest error"; empty: not shown there
    std::string_view valueName{};  ///< in --help: "MM"
    std::string_view help{};       ///< one sentence or two, without the value's name and default
    std::string_view standard{};   ///< the default in words, where --help states it
    NumberRule rule{};             ///< of a number, or of a count, which is 0 or more
    /// Words of a choice, in the order of --help. For an enumeration: in the order of its values.
    std::span<const std::string_view> words{};
    /// Check of a text, and its rule in words. Empty: any text.
    bool (*isUsable)(std::string_view text) = nullptr;
    std::string_view textRule{};
};

enum class OptionKind { Flag, Number, Count, Choice, Text };

/// The help of an option with its rule and its default: "Make no new angle below this (a number
/// from 0 to 40, in degrees; default: 0)".
std::string helpText(const OptionFacts& facts, OptionKind kind);

/// Empty (monostate): not given. A choice is its word; it is read as a number where it is one.
using OptionValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

/// A value for people: "0.15 mm", "20°", "yes".
std::string valueText(const OptionValue& value, const NumberRule& rule);

/// A row: an option and the member of `Owner` that holds its value.
template <class Owner>
struct Option {
    OptionFacts facts;
    OptionKind kind;
    bool isOptional;  ///< may be empty
    OptionValue (*get)(const Owner&, const OptionFacts&);
    void (*set)(Owner&, const OptionValue&, const OptionFacts&);

    OptionValue valueOf(const Owner& owner) const { return get(owner, facts); }
    /// \pre value is of the kind and allowed by the facts
    void put(Owner& owner, const OptionValue& value) const { set(owner, value, facts); }
};

namespace detail {

template <class Member>
struct MemberOf;
template <class O, class V>
struct MemberOf<V O::*> {
    using Owner = O;
    using Value = V;
};

template <class T>
struct Unwrapped {
    using Type = T;
    static constexpr bool kIsOptional = false;
};
template <class T>
struct Unwrapped<std::optional<T>> {
    using Type = T;
    static constexpr bool kIsOptional = true;
};

template <class Value>
OptionValue toOptionValue(const Value& value, const OptionFacts& facts) {
    if constexpr (std::is_enum_v<Value>) {
        return std::string(facts.words[static_cast<std::size_t>(value)]);
    } else if constexpr (std::is_same_v<Value, int>) {
        return std::int64_t{value};
    } else {
        return value;
    }
}

template <class Value>
Value fromOptionValue(const OptionValue& value, const OptionFacts& facts) {
    if constexpr (std::is_enum_v<Value>) {
        const std::string& word = std::get<std::string>(value);
        for (std::size_t n = 0; n < facts.words.size(); ++n) {
            if (facts.words[n] == word) return static_cast<Value>(n);
        }
        throw std::logic_error("fromOptionValue: no such word");
    } else if constexpr (std::is_same_v<Value, int>) {
        return std::stoi(std::get<std::string>(value));
    } else {
        return std::get<Value>(value);
    }
}

}  // namespace detail

/// The row of a member: a bool is a flag, a double a number, a 64-bit integer a count, an
/// enumeration or an int one of `facts.words`, a string a text.
template <auto member>
constexpr auto option(const OptionFacts& facts) {
    using Owner = typename detail::MemberOf<decltype(member)>::Owner;
    using Held = typename detail::MemberOf<decltype(member)>::Value;
    using Value = typename detail::Unwrapped<Held>::Type;
    constexpr bool kIsOptional = detail::Unwrapped<Held>::kIsOptional;
    constexpr OptionKind kKind = std::is_same_v<Value, bool>           ? OptionKind::Flag
                                 : std::is_same_v<Value, double>       ? OptionKind::Number
                                 : std::is_same_v<Value, std::int64_t> ? OptionKind::Count
                                 : std::is_same_v<Value, std::string>  ? OptionKind::Text
                                                                       : OptionKind::Choice;
    return Option<Owner>{facts, kKind, kIsOptional,
                         [](const Owner& owner, const OptionFacts& of) -> OptionValue {
                             if constexpr (kIsOptional) {
                                 if (!(owner.*member)) return {};
                                 return detail::toOptionValue<Value>(*(owner.*member), of);
                             } else {
                                 return detail::toOptionValue<Value>(owner.*member, of);
                             }
                         },
                         [](Owner& owner, const OptionValue& value, const OptionFacts& of) {
                             if constexpr (kIsOptional) {
                                 if (std::holds_alternative<std::monostate>(value)) {
                                     (owner.*member).reset();
                                     return;
                                 }
                             }
                             owner.*member = detail::fromOptionValue<Value>(value, of);
                         }};
}

/// The rows of an options struct.
template <class Owner>
using Options = std::vector<Option<Owner>>;

/// "--largest, --min-volume, --fill-cavities"
template <class Owner>
std::string namesOf(const Options<Owner>& rows) {
    std::string names;
    for (const Option<Owner>& row : rows) {
        names += (names.empty() ? "--" : ", --") + std::string(row.facts.name);
    }
    return names;
}

}  // namespace adaptiso
