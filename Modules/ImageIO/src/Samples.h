#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "ByteSource.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {

/// Memory for samples: uninitialised, aligned for any pixel type, owned.
using SampleBuffer = std::shared_ptr<std::byte[]>;

/// float32 holds every value of `stored`, or else float64.
inline PixelType floatTypeFor(PixelType stored) {
    return bytesPerPixel(stored) <= 2 || stored == PixelType::Float32 ? PixelType::Float32
                                                                      : PixelType::Float64;
}

/// slope * stored + intercept; infinite where `Out` can't hold that.
template <class Out>
Out scaledSample(double stored, double slope, double intercept) {
    const double value = slope * stored + intercept;
    if (std::is_same_v<Out, float> && std::abs(value) > std::numeric_limits<float>::max()) {
        return static_cast<Out>(std::copysign(std::numeric_limits<double>::infinity(), value));
    }
    return static_cast<Out>(value);
}

/// Bytes that an image of this size takes.
/// \throws FileError when an extent is < 1, there is one slice only, or the product overflows
std::uint64_t requireImageBytes(const std::filesystem::path& file, const Index3& size,
                                PixelType type);

/// a * b. \throws FileError when that is more than any file holds
std::uint64_t requireProduct(const std::filesystem::path& file, std::uint64_t a, std::uint64_t b);

/// In a sandbox process it is memory that the parent process sees too.
/// \throws FileError when memory is short
SampleBuffer allocateSamples(const std::filesystem::path& file, std::uint64_t byteCount);

/// \throws FileError unless spacings are plausible (1e-6 to 1e6 mm), so is the origin (-1e9 to 1e9
///         mm along each axis), all numbers are finite and the axes span a volume
void requireUsableGeometry(const std::filesystem::path& file, const ImageGeometry& geometry);

/// Turns every sample's bytes round where the file's byte order is not this machine's.
void swapBytes(std::byte* samples, std::uint64_t byteCount, std::size_t bytesPerSample);

/// Stored form of a file's samples and the conversion they need.
struct SampleLayout {
    PixelType stored = PixelType::UInt8;
    std::endian byteOrder = std::endian::native;
    bool isScaled = false;  ///< value = slope * stored + intercept
    double slope = 1;
    double intercept = 0;
    std::int64_t volumeCount = 1;  ///< of one size, one after the other
    std::int64_t volume = 0;       ///< the one to read, from 0
    bool isInterleaved = false;    ///< or all volumes' samples of a voxel side by side

    /// "scl_slope 0.5, scl_inter 0"; empty where nothing is scaled.
    std::string scalingText(const char* slopeName, const char* interceptName) const;
};

/// The volume to read of a file that holds `count`.
/// \param several  the refusal of several volumes; empty: "is 4-D: it holds 3 volumes"
/// \throws FileError  there are several and none was chosen, or one that is not there
std::int64_t chooseVolume(const std::filesystem::path& file, std::int64_t count,
                          const ReadOptions& options, const std::string& several = {});

/// Reads exactly the geometry's voxels, checks that the file holds the other volumes too, and wraps
/// the samples up. What follows in the file is `source`'s tail then.
/// \throws FileError  samples are missing, or the scaling makes finite ones infinite
Volume readSamples(const std::filesystem::path& file, ByteSource& source,
                   const SampleLayout& layout, const ImageGeometry& geometry);

/// A volume that owns `samples`.
Volume makeVolume(SampleBuffer samples, PixelType type, const ImageGeometry& geometry);

}  // namespace adaptiso::detail
