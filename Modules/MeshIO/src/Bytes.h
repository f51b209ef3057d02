#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <string>
#include <string_view>

#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::meshio {

/// Fails with FileError "<what>; the file is cut off or damaged, ...": bytes that are missing or
/// that no program writes. decodeMesh() puts the file's name in front.
[[noreturn]] void damaged(const std::string& what);

/// Fails with FileError "<what>; ... save it again ...": text that may be another program's
/// dialect.
[[noreturn]] void malformed(const std::string& what);

/// Fails with FileError "<what>; <advice>": a sound file of a kind that is not read.
[[noreturn]] void unsupported(const std::string& what, const std::string& advice);

/// Damaged unless `bytesLeft` can hold `count` records of at least `bytesEach` (> 0) bytes: to be
/// asked before anything of that size is allocated or looped over.
void requireRoom(std::string_view what, std::int64_t count, std::int64_t bytesEach,
                 std::size_t bytesLeft);

inline bool isReal(PixelType type) {
    return type == PixelType::Float32 || type == PixelType::Float64;
}

template <class T>
T loadAs(const char* bytes, std::endian order) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return order == std::endian::native ? value : swappedBytes(value);
}

/// Walks over the bytes of a file: numbers, lines and words. Going past the end is damage.
class ByteSource {
public:
    explicit ByteSource(std::string_view bytes) : bytes_(bytes) {}

    std::size_t left() const { return bytes_.size() - position_; }
    std::size_t position() const { return position_; }
    bool atEnd() const { return left() == 0; }
    std::string_view rest() const { return bytes_.substr(position_); }
    void seek(std::size_t position) { position_ = position; }  ///< \pre <= the number of bytes

    std::string_view take(std::size_t count);
    template <class T>
    T number(std::endian order) {
        return loadAs<T>(take(sizeof(T)).data(), order);
    }
    /// The next number, stored as `type`.
    template <class T>
    T number(PixelType type, std::endian order) {
        return withPixelType(
            type, [&]<class Stored>(Stored) { return static_cast<T>(number<Stored>(order)); });
    }
    /// Up to the next line feed, carriage return, or pair of both, without these.
    std::string_view line();
    /// The next word (no space inside); empty at the end of the bytes.
    std::string_view word();
    /// The next word; damage at the end.
    std::string_view requireWord(std::string_view what);
    std::int64_t integerWord(std::string_view what);
    double realWord(std::string_view what);

private:
    std::string_view bytes_;
    std::size_t position_ = 0;
};

/// Start of a comment, '#' at the start of a word; npos if there is none.
std::size_t findComment(std::string_view line);

/// The number that `word` spells, all of it, whatever the locale; fails otherwise. Whole numbers
/// may be written as reals, exponents with D. `what` is what it stands for.
std::int64_t toInteger(std::string_view word, std::string_view what);
double toReal(std::string_view word, std::string_view what);

/// `value` as float; damage where float can't hold it (NaN and infinities pass: decodeMesh()
/// refuses them).
float toFloat(double value, std::string_view what);

/// Calls make(); errors get the file's name.
template <class Make>
auto naming(std::string_view name, const Make& make) {
    const std::string prefix = std::string(name) + ": ";
    try {
        return make();
    } catch (const FileError& error) {
        throw FileError(prefix + error.what());
    } catch (const std::bad_alloc&) {
        throw FileError(prefix + "it does not fit into memory; use a larger machine");
    }
}

/// The bytes of a regular file, at most `most`. \throws FileError  "<file>: what is wrong; what to
/// do"
std::string readBytes(const std::filesystem::path& path,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

}  // namespace adaptiso::meshio
