#include "Support/ScannedPhantoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace adaptiso::testing {
namespace {

/// Normally distributed as near as matters here, mean 0, deviation 1: twelve uniform numbers less
/// six, so that no library's logarithm has a say.
double nextNoise(std::uint64_t& state) {
    double sum = -6;
    for (int n = 0; n < 12; ++n) sum += static_cast<double>(nextRandom(state) >> 11) * 0x1.0p-53;
    return sum;
}

/// `value` of each voxel's index, rounded and saturated.
template <class Value>
Volume scanned(const ImageGeometry& geometry, Value&& value) {
    using Limits = std::numeric_limits<std::int16_t>;
    std::vector<std::int16_t> samples;
    samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                const double exact = value(
                    Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                samples.push_back(static_cast<std::int16_t>(
                    std::clamp<double>(std::round(exact), Limits::min(), Limits::max())));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Share of the voxel at `index` that lies in the solid.
double shareInside(const Shape& solid, const ImageGeometry& geometry, const Vec3& index) {
    constexpr int kSteps = 8;  // along each axis: steps of 0.06 mm
    const double halfDiagonalMm = 0.5 * norm(geometry.spacingMm());
    const double depthMm = solid.depthMm(geometry.toPhysical(index));
    if (std::abs(depthMm) > halfDiagonalMm) return depthMm > 0 ? 1 : 0;
    int inside = 0;
    for (int n = 0; n < kSteps * kSteps * kSteps; ++n) {
        const auto offset = [](int step) { return (step + 0.5) / kSteps - 0.5; };
        const Vec3 part{offset(n % kSteps), offset(n / kSteps % kSteps),
                        offset(n / (kSteps * kSteps))};
        if (solid.depthMm(geometry.toPhysical(index + part)) > 0) ++inside;
    }
    return static_cast<double>(inside) / (kSteps * kSteps * kSteps);
}

template <class T>
void put(std::string& header, std::size_t at, T value) {
    std::memcpy(header.data() + at, &value, sizeof value);
}

}  // namespace

Volume distanceScan(const Shape& solid, const ImageGeometry& geometry) {
    return scanned(geometry, [&](const Vec3& index) {
        return kDistanceSurface + kDistancePerMm * solid.depthMm(geometry.toPhysical(index));
    });
}

Volume bearingBalls(double diameterMm) {
    constexpr double kAirHu = -1000, kSteelHu = 3000, kNoiseHu = 20;
    constexpr double kVoxelMm = 0.5, kGapMm = 3;
    // not on the lattice: a quarter of a voxel beside it along every axis
    const double shift = 0.5 * (diameterMm + kGapMm);
    const std::array balls{sphere({-shift + 0.12, 0.13, 0.11}, diameterMm / 2),
                           sphere({shift + 0.12, 0.13, 0.11}, diameterMm / 2)};
    const auto voxels = [](double mm) { return static_cast<std::int64_t>(mm / kVoxelMm) + 9; };
    const ImageGeometry geometry =
        centredGeometry({voxels(2 * diameterMm + kGapMm), voxels(diameterMm), voxels(diameterMm)},
                        {kVoxelMm, kVoxelMm, kVoxelMm});
    std::uint64_t state = 10;
    return scanned(geometry, [&](const Vec3& index) {
        const double share =
            shareInside(balls[0], geometry, index) + shareInside(balls[1], geometry, index);
        return kAirHu + (kSteelHu - kAirHu) * share + kNoiseHu * nextNoise(state);
    });
}

std::string niftiFile(const VolumeView& scan) {
    constexpr std::size_t kHeaderBytes = 352;
    const ImageGeometry& geometry = scan.geometry();
    std::string file(kHeaderBytes, '\0');
    put(file, 0, std::int32_t{348});
    put(file, 40, std::int16_t{3});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(file, 42 + 2 * axis, static_cast<std::int16_t>(geometry.size[axis]));
        put(file, 80 + 4 * axis, static_cast<float>(geometry.spacingMm()[static_cast<int>(axis)]));
    }
    for (std::size_t n = 48; n < 56; n += 2) put(file, n, std::int16_t{1});
    put(file, 70, std::int16_t{4});  // signed 16 bits
    put(file, 72, std::int16_t{16});
    put(file, 76, 1.0F);
    put(file, 108, static_cast<float>(kHeaderBytes));
    put(file, 123, std::int8_t{2});   // mm
    put(file, 254, std::int16_t{1});  // the sform says where scanner space is
    for (int row = 0; row < 3; ++row) {
        const double turn = row < 2 ? -1 : 1;  // LPS -> RAS
        const auto at = static_cast<std::size_t>(280 + 16 * row);
        for (int column = 0; column < 3; ++column) {
            const Vec3& step = geometry.indexToPhysical.column[static_cast<std::size_t>(column)];
            put(file, at + 4 * static_cast<std::size_t>(column),
                static_cast<float>(turn * step[row]));
        }
        put(file, at + 12, static_cast<float>(turn * geometry.originMm[row]));
    }
    file.replace(344, 4, std::string("n+1\0", 4));
    file.append(static_cast<const char*>(scan.samples()),
                static_cast<std::size_t>(geometry.voxelCount()) * sizeof(std::int16_t));
    return file;
}

}  // namespace adaptiso::testing
