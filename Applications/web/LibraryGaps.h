#pragma once

/// Parts that the C++20 library of Emscripten 3.1.6 (libc++ 14) lacks, in std: included before
/// every source of the build for the browser, so that the modules need no second wording. Each part
/// goes when a newer library has it; Decisions/0012-the-programs-in-a-page.md says why it stands
/// here.
#ifdef __cplusplus
#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

namespace std {

// ---- <bit>, <memory>, <atomic>

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}

template <class Array>
requires(is_array_v<Array>) shared_ptr<Array> make_shared_for_overwrite(size_t count) {
    return shared_ptr<Array>(new remove_extent_t<Array>[count]);
}

template <class Array>
requires(is_array_v<Array>) unique_ptr<Array> make_unique_for_overwrite(size_t count) {
    return unique_ptr<Array>(new remove_extent_t<Array>[count]);
}

/// One thread: plain memory.
template <class T>
class atomic_ref {
public:
    explicit atomic_ref(T& value) : value_(value) {}
    T load(memory_order = memory_order_seq_cst) const { return value_; }
    void store(T value, memory_order = memory_order_seq_cst) const { value_ = value; }
    T fetch_add(T more, memory_order = memory_order_seq_cst) const {
        return std::exchange(value_, value_ + more);
    }
    T fetch_or(T bits, memory_order = memory_order_seq_cst) const {
        return std::exchange(value_, static_cast<T>(value_ | bits));
    }

private:
    T& value_;
};
template <class T>
atomic_ref(T&) -> atomic_ref<T>;

// ---- <charconv> of doubles and floats. fmt finds the digits; their layout is the standard's:
// printf's.

to_chars_result to_chars(char* first, char* last, double value);
to_chars_result to_chars(char* first, char* last, float value);
to_chars_result to_chars(char* first, char* last, double value, chars_format format);
to_chars_result to_chars(char* first, char* last, double value, chars_format format, int precision);
to_chars_result to_chars(char* first, char* last, float value, chars_format format, int precision);
from_chars_result from_chars(const char* first, const char* last, double& value);
from_chars_result from_chars(const char* first, const char* last, float& value);

// ---- <algorithm> of ranges, as far as they are used

namespace ranges {
namespace gaps {

template <class Less, class Projection>
auto projected(Less less, Projection projection) {
    return [less, projection](const auto& a, const auto& b) -> bool {
        return std::invoke(less, std::invoke(projection, a), std::invoke(projection, b));
    };
}

}  // namespace gaps

#define ADAPTISO_RANGE(name)                                       \
    template <class Range, class... Arguments>                     \
    constexpr auto name(Range&& range, Arguments&&... arguments) { \
        return std::name(std::begin(range), std::end(range),       \
                         std::forward<Arguments>(arguments)...);   \
    }
ADAPTISO_RANGE(copy)
ADAPTISO_RANGE(fill)
ADAPTISO_RANGE(is_sorted)
ADAPTISO_RANGE(move)
ADAPTISO_RANGE(replace)
ADAPTISO_RANGE(reverse)
ADAPTISO_RANGE(transform)
#undef ADAPTISO_RANGE

#define ADAPTISO_PREDICATE(name)                                                             \
    template <class Range, class Predicate, class Projection = identity>                     \
    constexpr auto name(Range&& range, Predicate predicate, Projection projection = {}) {    \
        return std::name(std::begin(range), std::end(range), [&](auto&& each) -> bool {      \
            return std::invoke(predicate,                                                    \
                               std::invoke(projection, std::forward<decltype(each)>(each))); \
        });                                                                                  \
    }
ADAPTISO_PREDICATE(all_of)
ADAPTISO_PREDICATE(any_of)
ADAPTISO_PREDICATE(count_if)
ADAPTISO_PREDICATE(find_if)
ADAPTISO_PREDICATE(none_of)
#undef ADAPTISO_PREDICATE

template <class A, class B, class Same = ranges::equal_to, class First = identity,
          class Second = identity>
constexpr bool equal(const A& a, const B& b, Same same = {}, First first = {}, Second second = {}) {
    return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b),
                      [&](const auto& one, const auto& other) {
                          return std::invoke(same, std::invoke(first, one),
                                             std::invoke(second, other));
                      });
}
template <class Range>
constexpr auto unique(Range&& range) {
    return subrange(std::unique(std::begin(range), std::end(range)), std::end(range));
}

template <class Range, class T, class Projection = identity>
constexpr auto find(Range&& range, const T& value, Projection projection = {}) {
    return std::find_if(std::begin(range), std::end(range),
                        [&](const auto& each) { return std::invoke(projection, each) == value; });
}
template <class Range, class T, class Projection = identity>
constexpr auto count(Range&& range, const T& value, Projection projection = {}) {
    return std::count_if(std::begin(range), std::end(range),
                         [&](const auto& each) { return std::invoke(projection, each) == value; });
}
template <class Range, class T>
constexpr bool contains(Range&& range, const T& value) {
    return find(range, value) != std::end(range);
}
template <class Range, class T, class Less = ranges::less, class Projection = identity>
constexpr auto lower_bound(Range&& range, const T& value, Less less = {},
                           Projection projection = {}) {
    return std::lower_bound(std::begin(range), std::end(range), value,
                            [&](const auto& each, const T& than) {
                                return std::invoke(less, std::invoke(projection, each), than);
                            });
}
#define ADAPTISO_ORDERED(name)                                                                   \
    template <class Range, class Less = ranges::less, class Projection = identity>               \
    constexpr auto name(Range&& range, Less less = {}, Projection projection = {}) {             \
        return std::name(std::begin(range), std::end(range), gaps::projected(less, projection)); \
    }
ADAPTISO_ORDERED(sort)
ADAPTISO_ORDERED(stable_sort)
ADAPTISO_ORDERED(max_element)
ADAPTISO_ORDERED(min_element)
#undef ADAPTISO_ORDERED

template <class Iterator>
struct min_max_result {
    Iterator min, max;
};
template <class Range, class Less = ranges::less, class Projection = identity>
constexpr auto minmax_element(Range&& range, Less less = {}, Projection projection = {}) {
    const auto [low, high] =
        std::minmax_element(std::begin(range), std::end(range), gaps::projected(less, projection));
    return min_max_result<std::decay_t<decltype(low)>>{low, high};
}
template <class Range, class Same = ranges::equal_to, class Projection = identity>
constexpr auto adjacent_find(Range&& range, Same same = {}, Projection projection = {}) {
    return std::adjacent_find(std::begin(range), std::end(range),
                              gaps::projected(same, projection));
}
template <class Range, class Less = ranges::less, class Projection = identity>
constexpr auto minmax(const Range& range, Less less = {}, Projection projection = {}) {
    const auto [low, high] =
        std::minmax_element(std::begin(range), std::end(range), gaps::projected(less, projection));
    return min_max_result<std::decay_t<decltype(*low)>>{*low, *high};
}
template <class Range>
constexpr auto min(const Range& range) {
    return *std::min_element(std::begin(range), std::end(range));
}
template <class Range>
constexpr auto max(const Range& range) {
    return *std::max_element(std::begin(range), std::end(range));
}

}  // namespace ranges
}  // namespace std
#endif
