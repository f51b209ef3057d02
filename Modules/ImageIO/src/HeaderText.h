#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Text.h"

/// Shared by the text headers of NRRD and MetaImage.
namespace adaptiso::detail {

/// Cut at blanks.
std::vector<std::string_view> words(std::string_view text);

/// Whether an axis of this kind, in lower case, is or may be a direction in space.
bool isSpatialKind(std::string_view kind);

/// All of `text` as one number; nothing else, no NaN or infinity for integers.
std::optional<double> parseNumber(std::string_view text);
std::optional<std::int64_t> parseInteger(std::string_view text);
/// The same as T, any integer type of samples; empty if T can't hold it.
template <class T>
std::optional<T> parseNumberAs(std::string_view text);

/// Bytes of the longest header that is read.
constexpr std::size_t kLongestHeader = std::size_t{1} << 20;

/// The first bytes of a file, at most `most` of them.
std::string readHead(const std::filesystem::path& file, std::size_t most);

/// Numbers at fixed places of a binary header, in either byte order.
class HeaderBytes {
public:
    HeaderBytes(std::string_view bytes, std::endian order)
        : bytes_(bytes), swap_(order != std::endian::native) {}

    /// \pre offset + sizeof(T) <= size()
    template <class T>
    T at(std::size_t offset) const {
        char raw[sizeof(T)] = {};
        bytes_.copy(raw, sizeof(T), offset);
        if (swap_) std::reverse(raw, raw + sizeof(T));
        T value;
        std::memcpy(&value, raw, sizeof(T));
        return value;
    }
    std::size_t size() const { return bytes_.size(); }

private:
    std::string_view bytes_;
    bool swap_;
};

}  // namespace adaptiso::detail
