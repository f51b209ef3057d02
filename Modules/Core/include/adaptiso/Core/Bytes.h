#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

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
    /// "x y z"
    ByteSink& operator<<(const Vec3& p) { return *this << p.x << " " << p.y << " " << p.z; }

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

/// The text of errno, for messages.
std::string systemReason();

/// As few characters as read back as the same number.
std::string shortestText(double number);

/// Makes a file, or replaces what is in it, with what `write` hands to the sink.
/// \throws FileError  "<file>: what is wrong; what to do"
void writeBytes(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write);
void writeText(const std::filesystem::path& path, std::string_view text);

}  // namespace adaptiso
