#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "Surfaces.h"
#include "adaptive/rounds/BrickRound.h"

namespace adaptiso::testing {

inline ImageGeometry unitGeometry(const Index3& size) {
    ImageGeometry geometry;
    geometry.size = size;
    return geometry;
}

/// Every sample by chance, around 0.
inline Volume whiteNoise(const Index3& size, unsigned seed) {
    std::mt19937 random(seed);
    const ImageGeometry geometry = unitGeometry(size);
    std::vector<float> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (float& s : samples) s = static_cast<float>(random() % 2001) - 1000;
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Noise below x = 30, waves around the middle of z above.
/// \param geometry  its size counts for nothing
inline Volume noiseBesideSmooth(const Index3& size, ImageGeometry geometry, int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    geometry.size = size;
    std::vector<float> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const auto x = static_cast<double>(i % size[0]),
                   y = static_cast<double>(i / size[0] % size[1]),
                   z = static_cast<double>(i / (size[0] * size[1]));
        const double wave = z - 0.5 * static_cast<double>(size[2]) + std::sin(0.3 * x + 0.2 * y);
        const double noise = static_cast<double>(random() % 2001) / 1000 - 1;
        samples.push_back(static_cast<float>(x < 30 ? noise : wave));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

inline detail::PatchLimits limitsThatLeaveNoise() {
    detail::PatchLimits limits;
    limits.maxCost = 10;
    limits.maxDistanceMm = 0.3;
    limits.leavesNoise = true;
    return limits;
}

inline detail::SimplifiedSurface firstRoundOf(const Scene& scene) {
    return detail::simplifyBricks(*scene.sampler, scene.bricks, scene.frame, limitsThatLeaveNoise(),
                                  nullptr);
}

}  // namespace adaptiso::testing
