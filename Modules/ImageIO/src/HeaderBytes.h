#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace adaptiso::detail {

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
