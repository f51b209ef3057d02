#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "Support/AnalyticVolumes.h"

namespace adaptiso::testing {

/// The kinds of geometry that a step in mm must not tell apart, all of one size and spacing.
inline std::vector<std::pair<std::string, ImageGeometry>> kindsOfGrid(const Index3& size,
                                                                      const Vec3& spacingMm) {
    return {{"centred", centredGeometry(size, spacingMm)},
            {"oblique", obliqueGeometry(size, spacingMm)},
            {"sheared", shearedGeometry(size, spacingMm)},
            {"mirrored", mirroredGeometry(size, spacingMm)}};
}

/// Calls visit(n, point) for every voxel, in order: its number and its place in mm.
template <class Visit>
void forEachVoxel(const ImageGeometry& geometry, const Visit& visit) {
    std::size_t n = 0;
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i, ++n) {
                visit(n, geometry.toPhysical({static_cast<double>(i), static_cast<double>(j),
                                              static_cast<double>(k)}));
            }
        }
    }
}

/// Samples value(point in mm), rounded to T.
template <class T, class Value>
Volume sampledFrom(const ImageGeometry& geometry, const Value& value) {
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    forEachVoxel(geometry, [&](std::size_t n, const Vec3& point) {
        samples[n] = static_cast<T>(value(point));
    });
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace adaptiso::testing
