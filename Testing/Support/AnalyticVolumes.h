#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::testing {

/// A solid whose surface is known on paper.
struct Shape {
    /// How deep a point (LPS mm) lies inside, mm: the exact distance to the surface, negative
    /// outside. Zero on the surface.
    std::function<double(const Vec3&)> depthMm;
    std::optional<double> volumeMm3;  ///< none: unbounded
    std::optional<double> areaMm2;    ///< none: unbounded
    int components = 1;               ///< pieces of the surface
    int genus = 0;                    ///< of all pieces together
};

/// \pre radiusMm > 0
Shape sphere(const Vec3& centreMm, double radiusMm);
/// Ring about the z axis through `centreMm`. \pre majorRadiusMm > minorRadiusMm > 0
Shape torus(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm);
/// The solid between two concentric spheres: two surfaces. \pre outerRadiusMm > innerRadiusMm > 0
Shape shell(const Vec3& centreMm, double innerRadiusMm, double outerRadiusMm);
/// Faces across the x, y and z axes. \pre halfSizeMm > 0 along every axis
Shape box(const Vec3& centreMm, const Vec3& halfSizeMm);
/// Everything on the side of the plane through `pointMm` that `normal` points away from: its
/// surface is a sheet that only the volume's border ends. \pre normal is not zero
Shape halfSpace(const Vec3& pointMm, const Vec3& normal);

/// Axes along x, y, z; the middle of the volume lies at the origin.
ImageGeometry centredGeometry(const Index3& size, const Vec3& spacingMm = {1, 1, 1});
/// As centredGeometry, turned about an axis that no voxel axis shares.
ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm);
/// As centredGeometry, with slices that slip along y (gantry tilt): axes not at right angles.
ImageGeometry shearedGeometry(const Index3& size, const Vec3& spacingMm);
/// As obliqueGeometry, with the first axis reversed: negative determinant.
ImageGeometry mirroredGeometry(const Index3& size, const Vec3& spacingMm);

/// Samples of `shape` and what they mean.
struct AnalyticVolume {
    Volume volume;
    Shape shape;
    double isovalue;       ///< where the samples interpolate to the shape's surface
    double sampleErrorMm;  ///< how far rounding to the pixel type moves a sample's surface
};

/// `shape` in pixel type T: isovalue + gain * depth.
///
/// Integers are rounded and saturated to 0...127, which every type holds; the gain keeps the
/// saturation more than one cell away from the surface. Floats are neither.
template <class T>
AnalyticVolume sampled(Shape shape, const ImageGeometry& geometry) {
    constexpr double kIsovalue = 64;
    const auto& axes = geometry.indexToPhysical.column;
    const double cellMm = norm(axes[0]) + norm(axes[1]) + norm(axes[2]);  // >= any diagonal
    const double gain = std::is_integral_v<T> ? 60 / cellMm : 1;
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    std::size_t n = 0;
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                const Vec3 index{static_cast<double>(i), static_cast<double>(j),
                                 static_cast<double>(k)};
                double value = kIsovalue + gain * shape.depthMm(geometry.toPhysical(index));
                if constexpr (std::is_integral_v<T>) {
                    value = std::clamp(std::round(value), 0.0, 127.0);
                }
                samples[n++] = static_cast<T>(value);
            }
        }
    }
    return {Volume::fromSamples(std::move(samples), geometry), std::move(shape), kIsovalue,
            std::is_integral_v<T> ? 0.5 / gain : 0.0};
}

/// The next of a stream of random numbers [Steele2014, SplitMix64]: the same on every platform.
std::uint64_t nextRandom(std::uint64_t& state);

/// Noise: every sample is one of 0 ... distinctValues - 1, all as likely, in a volume of 1 mm
/// voxels with its first sample at the origin. The isovalues that meet all ambiguous cases lie
/// between. \pre 1 <= distinctValues, and T holds distinctValues - 1
template <class T>
Volume randomVolume(const Index3& size, int distinctValues, std::uint64_t seed) {
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (T& sample : samples) {
        sample = static_cast<T>(nextRandom(seed) % static_cast<std::uint64_t>(distinctValues));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace adaptiso::testing
