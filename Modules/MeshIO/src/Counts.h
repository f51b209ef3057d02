#pragma once

// What a file counts is held against what is there: one rule for all formats of surfaces
// (adaptiso/Core/Surplus.h; requireRoom() where less is there).

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Warning.h"

namespace adaptiso::meshio {

/// Records that a file counts: "triangles", 320, 50 bytes each (in text: 3 numbers).
struct Counted {
    std::string_view what;
    std::int64_t count = 0;
    std::int64_t each = 0;
};

/// Checks the bytes behind the last record. A few of them, or zeros, are a warning.
/// \throws FileError  they are more records, or begin as another surface does
void requireNoMore(const Counted& counted, std::string_view rest, std::vector<Warning>& warnings);

/// Refuses another file of the format `name` behind the records.
[[noreturn]] void refuseSecondFile(const Counted& counted, std::string_view name);

/// The same in text, where blanks are nothing.
void requireNoMoreText(const Counted& counted, std::string_view rest,
                       std::vector<Warning>& warnings);

/// What the arrays of a file take together, however many of them name the same bytes.
class Unpacking {
public:
    explicit Unpacking(std::size_t fileBytes) : fileBytes_(fileBytes) {}

    /// Before an array of `count` numbers is made. \throws FileError  as requirePlausibleSize()
    void add(std::int64_t count, std::size_t bytesEach);

    std::vector<Warning> warnings;

private:
    std::size_t fileBytes_, bytes_ = 0;
};

/// Whether a count is 0 or all ones, as programs leave it that write a stream.
bool isUnset(std::int64_t count);

/// Sets a count that isUnset() to the records that are `there`, with a warning.
void setToThere(Counted& counted, std::int64_t there, std::vector<Warning>& warnings);

}  // namespace adaptiso::meshio
