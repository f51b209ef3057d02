#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// True if lists and objects are nested deeper than in any JSON that is written on purpose.
bool isDeeplyNested(std::string_view json);

/// Follows a parser, and finds whether an object has a key twice.
template <class Json>
class RepeatedKeys {
public:
    bool areFound() const { return areFound_; }

    bool start_object(std::size_t) {
        keys_.emplace_back();
        return true;
    }
    bool key(typename Json::string_t& name) {
        areFound_ = areFound_ || !keys_.back().insert(name).second;
        return true;
    }
    bool end_object() {
        keys_.pop_back();
        return true;
    }
    bool start_array(std::size_t) { return true; }
    bool end_array() { return true; }
    bool null() { return true; }
    bool boolean(bool) { return true; }
    bool number_integer(typename Json::number_integer_t) { return true; }
    bool number_unsigned(typename Json::number_unsigned_t) { return true; }
    bool number_float(typename Json::number_float_t, const typename Json::string_t&) {
        return true;
    }
    bool string(typename Json::string_t&) { return true; }
    bool binary(typename Json::binary_t&) { return true; }
    template <class Error>
    bool parse_error(std::size_t, const std::string&, const Error&) {
        return false;
    }

private:
    std::vector<std::set<std::string>> keys_;  ///< of the objects that are open
    bool areFound_ = false;
};

/// Parses a text from outside. What copies, writes and removes JSON calls itself for each level, so
/// that deep nesting would end the program.
/// \tparam Json  nlohmann's, ordered or not
/// \return discarded (Json::is_discarded) where `text` is no JSON, isDeeplyNested(), or an object
///         has a key twice, of which programs take different ones
template <class Json>
Json parseJson(std::string_view text) {
    Json json(Json::value_t::discarded);
    if (isDeeplyNested(text)) return json;
    // a pass of its own: nlohmann's parser with a callback takes quadratic time for long arrays
    RepeatedKeys<Json> repeated;
    if (Json::sax_parse(text, &repeated) && !repeated.areFound()) {
        json = Json::parse(text, nullptr, false);
    }
    return json;
}

/// The whole number that `json` is. get() of one with a decimal point or an exponent is undefined
/// where the type can't hold it.
/// \throws Json::exception  it is another value
template <class Integer, class Json>
Integer wholeNumber(const Json& json) {
    using Unsigned = typename Json::number_unsigned_t;
    using Signed = typename Json::number_integer_t;
    return json.is_number_unsigned()
               ? static_cast<Integer>(json.template get_ref<const Unsigned&>())
               : static_cast<Integer>(json.template get_ref<const Signed&>());
}

}  // namespace adaptiso
