#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso::testing {

/// The blocks with a sample inside and a sample outside, sample by sample.
template <class T>
std::vector<std::uint32_t> blocksByDefinition(const VolumeView& volume, const BlockGrid& grid,
                                              double isovalue) {
    const auto view = volume.as<T>();
    std::vector<std::uint32_t> found;
    for (std::uint32_t b = 0; b < grid.blockCount(); ++b) {
        const Index3 first = grid.firstSample(b);
        bool inside = false, outside = false;
        for (int z = 0; z <= grid.blockSize; ++z) {
            for (int y = 0; y <= grid.blockSize; ++y) {
                for (int x = 0; x <= grid.blockSize; ++x) {
                    const Index3 p{first[0] + x, first[1] + y, first[2] + z};
                    bool isIn = true;
                    for (int a = 0; a < 3; ++a) isIn &= p[a] >= 0 && p[a] < view.geometry.size[a];
                    if (!isIn) {
                        outside |= grid.border == Border::Closed;
                        continue;
                    }
                    const bool reaches = static_cast<double>(view.at(p[0], p[1], p[2])) >= isovalue;
                    (reaches ? inside : outside) = true;
                }
            }
        }
        if (inside && outside) found.push_back(b);
    }
    return found;
}

/// Noise of few values in which an index of any type meets its extremes: the lowest and the highest
/// value of integers, infinities and NaN of floats. Each hides in one sample of fifty, so that most
/// blocks have ranges of their own.
template <class T>
Volume hardSamples(const Index3& size, std::uint64_t seed) {
    using Limits = std::numeric_limits<T>;
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<T> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (T& sample : samples) {
        const std::uint64_t random = nextRandom(seed);
        sample = static_cast<T>(random % 12);
        switch (random / 12 % 50) {
            case 0:
                sample = std::is_floating_point_v<T> ? -Limits::infinity() : Limits::lowest();
                break;
            case 1:
                sample = std::is_floating_point_v<T> ? Limits::infinity() : Limits::max();
                break;
            case 2:
                if constexpr (std::is_floating_point_v<T>) sample = Limits::quiet_NaN();
                break;
            default:
                break;
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// 1 ... `maximum` samples along each axis.
inline Index3 randomSize(std::uint64_t& state, std::uint64_t maximum) {
    Index3 size;
    for (auto& extent : size) extent = 1 + static_cast<std::int64_t>(nextRandom(state) % maximum);
    return size;
}

constexpr BlockSearchKind kSearches[] = {BlockSearchKind::KdTree, BlockSearchKind::Octree,
                                         BlockSearchKind::Linear};
constexpr int kBlockSizes[] = {2, 4, 8, 16};
constexpr Border kBorders[] = {Border::Closed, Border::Open};

}  // namespace adaptiso::testing
