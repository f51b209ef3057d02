#pragma once

#include "adaptiso/Core/Options.h"
#include "adaptiso/Json/Json.h"

namespace adaptiso {

/// The value of an option as reports have it; null: not given.
Json valueJson(const OptionValue& value);

/// Reads what valueJson() wrote. \throws Json::exception  where it is of another kind
OptionValue optionValue(const Json& json, OptionKind kind);

/// {name, key, kind, help, default, and what limits the value}: facts of an option for a program
/// that builds a form, a signature or a page from them. What is empty is left out.
Json factsJson(const OptionFacts& facts, OptionKind kind, const OptionValue& standard);

/// The values of rows by their keys.
template <class Owner>
Json valuesJson(const Options<Owner>& rows, const std::type_identity_t<Owner>& owner) {
    Json json = Json::object();
    for (const Option<Owner>& row : rows) {
        json[std::string(row.facts.key)] = valueJson(row.valueOf(owner));
    }
    return json;
}

/// factsJson() of rows.
template <class Owner>
Json describe(const Options<Owner>& rows) {
    Json list = Json::array();
    for (const Option<Owner>& row : rows) {
        list.push_back(factsJson(row.facts, row.kind, row.valueOf(Owner{})));
    }
    return list;
}

}  // namespace adaptiso
