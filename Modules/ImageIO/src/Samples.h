#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "ByteSource.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// Memory for samples: uninitialised, aligned for any pixel type, owned.
using SampleBuffer = std::shared_ptr<std::byte[]>;

/// Calls `f(T{})` with the C++ type of `type`: the readers' one dispatch over pixel types.
template <class F>
decltype(auto) withPixelType(PixelType type, F&& f) {
    switch (type) {
        case PixelType::UInt8:
            return f(std::uint8_t{});
        case PixelType::Int8:
            return f(std::int8_t{});
        case PixelType::UInt16:
            return f(std::uint16_t{});
        case PixelType::Int16:
            return f(std::int16_t{});
        case PixelType::UInt32:
            return f(std::uint32_t{});
        case PixelType::Int32:
            return f(std::int32_t{});
        case PixelType::UInt64:
            return f(std::uint64_t{});
        case PixelType::Int64:
            return f(std::int64_t{});
        case PixelType::Float32:
            return f(float{});
        case PixelType::Float64:
            return f(double{});
    }
    throw InternalError("withPixelType: unknown pixel type");
}

/// float32 holds every value of `stored`, or else float64.
inline PixelType floatTypeFor(PixelType stored) {
    return bytesPerPixel(stored) <= 2 || stored == PixelType::Float32 ? PixelType::Float32
                                                                      : PixelType::Float64;
}

/// Bytes that an image of this size takes.
/// \throws FileError when an extent is < 1, there is one slice only, or the product overflows
std::uint64_t requireImageBytes(const std::filesystem::path& file, const Index3& size,
                                PixelType type);

/// \throws FileError when memory is short
SampleBuffer allocateSamples(const std::filesystem::path& file, std::uint64_t byteCount);

/// \throws FileError unless spacings are plausible (1e-6 to 1e6 mm), all numbers finite and the
///         axes span a volume
void requireUsableGeometry(const std::filesystem::path& file, const ImageGeometry& geometry);

/// Turns every sample's bytes round where the file's byte order is not this machine's.
void swapBytes(std::byte* samples, std::uint64_t byteCount, std::size_t bytesPerSample);

/// How a file stores its samples and what has to become of them.
struct SampleLayout {
    PixelType stored = PixelType::UInt8;
    std::endian byteOrder = std::endian::native;
    bool isScaled = false;  ///< value = slope * stored + intercept
    double slope = 1;
    double intercept = 0;
};

/// Reads exactly the geometry's voxels, checks the checksum of compressed data and wraps them up.
Volume readSamples(const std::filesystem::path& file, ByteSource& source,
                   const SampleLayout& layout, const ImageGeometry& geometry);

/// A volume that owns `samples`.
Volume makeVolume(SampleBuffer samples, PixelType type, const ImageGeometry& geometry);

}  // namespace adaptiso::detail
