#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "adaptiso/Core/Text.h"

namespace adaptiso::meshio {

template <class T>
T swappedBytes(T value) {
    std::uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

/// Appends the bytes of a number, the least first.
template <class T>
void appendLittleEndian(T value, std::string& bytes) {
    if (std::endian::native == std::endian::big) value = swappedBytes(value);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Collects the bytes of a file in memory and hands them to a stream in large pieces. Errors of
/// the stream are the owner's to check, after finish().
class ByteSink {
public:
    explicit ByteSink(std::ostream& stream) : stream_(stream) { buffer_.reserve(kPiece + 256); }

    ByteSink& operator<<(std::string_view text) {
        buffer_.append(text);
        if (buffer_.size() >= kPiece) finish();
        return *this;
    }
    ByteSink& operator<<(std::int64_t number);
    /// Nine significant digits, as few characters as that takes; the same in every locale.
    ByteSink& operator<<(double number);

    template <class T>
    void littleEndian(T value) {
        put(std::endian::native == std::endian::little ? value : swappedBytes(value));
    }
    template <class T>
    void bigEndian(T value) {
        put(std::endian::native == std::endian::big ? value : swappedBytes(value));
    }

    void finish() {
        stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
    }

private:
    static constexpr std::size_t kPiece = std::size_t{1} << 20;

    template <class T>
    void put(const T& value) {
        *this << std::string_view(reinterpret_cast<const char*>(&value), sizeof(T));
    }

    std::ostream& stream_;
    std::string buffer_;
};

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

/// The bytes of a regular file, at most `most`. \throws FileError  "<file>: what is wrong; what to
/// do"
std::string readBytes(const std::filesystem::path& path,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Makes a file, or replaces what is in it, with what `write` hands to the sink.
/// \throws FileError  "<file>: what is wrong; what to do"
void writeBytes(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write);

}  // namespace adaptiso::meshio
