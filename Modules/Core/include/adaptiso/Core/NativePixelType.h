#pragma once

#include <type_traits>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// As pixelTypeOf(), of every number that C++ has: char, long long and the like, by size and sign.
template <class T>
constexpr PixelType nativePixelType() {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
    constexpr bool isSigned = std::is_signed_v<T>;
    if constexpr (std::is_floating_point_v<T>) {
        return pixelTypeOf<T>();
    } else {
        switch (sizeof(T)) {
            case 1:
                return isSigned ? PixelType::Int8 : PixelType::UInt8;
            case 2:
                return isSigned ? PixelType::Int16 : PixelType::UInt16;
            case 4:
                return isSigned ? PixelType::Int32 : PixelType::UInt32;
            default:
                return isSigned ? PixelType::Int64 : PixelType::UInt64;
        }
    }
}

}  // namespace adaptiso
