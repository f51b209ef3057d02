#include "Phantoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace adaptiso::checker::selftest {
namespace {

constexpr double kPi = std::numbers::pi;

/// Turns about an axis through the origin [Rodrigues' formula].
Mat3 rotation(const Vec3& axis, double radians) {
    const Vec3 u = normalized(axis);
    const auto turned = [&](const Vec3& v) {
        return std::cos(radians) * v + std::sin(radians) * cross(u, v) +
               (1 - std::cos(radians)) * dot(u, v) * u;
    };
    return {{{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}}};
}

/// The middle of the volume lies at the origin.
ImageGeometry centredGeometry(const Index3& size, const Mat3& indexToPhysical) {
    ImageGeometry geometry;
    geometry.size = size;
    geometry.indexToPhysical = indexToPhysical;
    geometry.originMm = -(indexToPhysical * Vec3{static_cast<double>(size[0] - 1) / 2,
                                                 static_cast<double>(size[1] - 1) / 2,
                                                 static_cast<double>(size[2] - 1) / 2});
    return geometry;
}

/// The next of a stream of random numbers [Steele2014, SplitMix64]: the same on every platform.
std::uint64_t nextRandom(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

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
double shareInside(const Solid& solid, const ImageGeometry& geometry, const Vec3& index) {
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

Solid ball(const Vec3& centreMm, double radiusMm) {
    return {[=](const Vec3& p) { return radiusMm - norm(p - centreMm); },
            4 * kPi / 3 * std::pow(radiusMm, 3),
            4 * kPi * radiusMm * radiusMm,
            0,
            centreMm,
            radiusMm};
}

Solid ring(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm) {
    return {[=](const Vec3& p) {
                const Vec3 d = p - centreMm;
                return minorRadiusMm - std::hypot(std::hypot(d.x, d.y) - majorRadiusMm, d.z);
            },
            2 * kPi * kPi * majorRadiusMm * minorRadiusMm * minorRadiusMm,
            4 * kPi * kPi * majorRadiusMm * minorRadiusMm,
            1,
            centreMm,
            std::min(minorRadiusMm, majorRadiusMm - minorRadiusMm)};
}

ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm, const Solid& solid) {
    ImageGeometry geometry = centredGeometry(
        size, rotation({1, 2, 3}, 0.7) * Mat3::diagonal(spacingMm.x, spacingMm.y, spacingMm.z));
    geometry.originMm += solid.centreMm;
    return geometry;
}

Volume distanceScan(const Solid& solid, const ImageGeometry& geometry) {
    return scanned(geometry, [&](const Vec3& index) {
        return kDistanceSurface + kDistancePerMm * solid.depthMm(geometry.toPhysical(index));
    });
}

Volume bearingBalls(double diameterMm) {
    constexpr double kAirHu = -1000, kSteelHu = 3000, kNoiseHu = 20;
    constexpr double kVoxelMm = 0.5, kGapMm = 3;
    // not on the lattice: a quarter of a voxel beside it along every axis
    const double shift = 0.5 * (diameterMm + kGapMm);
    const std::array balls{ball({-shift + 0.12, 0.13, 0.11}, diameterMm / 2),
                           ball({shift + 0.12, 0.13, 0.11}, diameterMm / 2)};
    const auto voxels = [](double mm) { return static_cast<std::int64_t>(mm / kVoxelMm) + 9; };
    const ImageGeometry geometry =
        centredGeometry({voxels(2 * diameterMm + kGapMm), voxels(diameterMm), voxels(diameterMm)},
                        Mat3::diagonal(kVoxelMm, kVoxelMm, kVoxelMm));
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

}  // namespace adaptiso::checker::selftest
