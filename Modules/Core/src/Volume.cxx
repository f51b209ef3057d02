#include "adaptiso/Core/Volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

double leastPlaneDistanceMm(const ImageGeometry& geometry) {
    const Mat3 toIndex = transpose(inverse(geometry.indexToPhysical));
    return 1 /
           std::max({norm(toIndex.column[0]), norm(toIndex.column[1]), norm(toIndex.column[2])});
}

void requireNoNeedles(const ImageGeometry& geometry) {
    constexpr double kMost = 10'000;
    const Vec3 spacingMm = geometry.spacingMm();
    const double longestMm = std::max({spacingMm.x, spacingMm.y, spacingMm.z});
    const double thinMm = leastPlaneDistanceMm(geometry);
    if (longestMm <= kMost * thinMm) return;
    throw InvalidInput("a voxel is " + formatShort(longestMm) + " mm long and " +
                       formatShort(thinMm) + " mm thin, must be at most 10,000 times as long");
}

std::string_view toString(PixelType type) {
    constexpr const char* kWords[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                      "int32", "uint64", "int64",  "float32", "float64"};
    return kWords[static_cast<std::size_t>(type)];
}

std::size_t bytesPerPixel(PixelType type) {
    constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kBytes[static_cast<std::size_t>(type)];
}

VolumeView::VolumeView(const void* samples, PixelType type, const ImageGeometry& geometry)
    : samples_(samples), type_(type), geometry_(geometry) {
    for (const std::int64_t extent : geometry.size) {
        if (extent < 1) {
            throw InvalidInput("the image has " + std::to_string(extent) +
                               " voxels along an axis, must have at least 1");
        }
    }
    const double volumeMm3 = geometry.voxelVolumeMm3();
    if (!(volumeMm3 > 0) || !std::isfinite(volumeMm3) ||
        !std::isfinite(squaredNorm(geometry.originMm))) {
        throw InvalidInput("the image's axes span no volume (voxel volume " +
                           formatShort(volumeMm3) + " mm3)");
    }
}

namespace {

template <class T>
constexpr T largest() {
    using Limits = std::numeric_limits<T>;
    return Limits::has_infinity ? Limits::infinity() : Limits::max();
}

template <class T>
constexpr T least() {
    using Limits = std::numeric_limits<T>;
    return Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
}

}  // namespace

ValueRange valueRange(const VolumeView& volume) {
    return dispatchPixelType(volume, [](const auto& view) {
        ValueRange range{std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()};
        std::mutex mutex;
        parallelForPieces(view.geometry.voxelCount(), std::int64_t{1} << 20,
                          [&](std::int64_t begin, std::int64_t end) {
                              using T = std::decay_t<decltype(*view.samples)>;
                              T low = largest<T>(), high = least<T>();
                              bool found = false;
                              for (std::int64_t i = begin; i < end; ++i) {
                                  const T value = view.samples[i];
                                  if (!(value == value)) continue;  // NaN
                                  found = true;
                                  low = value < low ? value : low;
                                  high = value > high ? value : high;
                              }
                              if (!found) return;
                              const std::lock_guard lock(mutex);
                              range.minimum = std::min(range.minimum, static_cast<double>(low));
                              range.maximum = std::max(range.maximum, static_cast<double>(high));
                          });
        return range;
    });
}

}  // namespace adaptiso
