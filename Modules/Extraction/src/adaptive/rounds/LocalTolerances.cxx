#include "adaptive/rounds/LocalTolerances.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "adaptive/Parameters.h"

namespace adaptiso::detail {

Index3 LocalTolerances::cubeAt(const Vec3& place, int level) {
    const double side = std::ldexp(kToleranceCube, level);
    Index3 cube;
    for (int a = 0; a < 3; ++a) cube[a] = static_cast<std::int64_t>(std::floor(place[a] / side));
    return cube;
}

std::set<Index3> LocalTolerances::cubesAround(const std::vector<Vec3>& places, int level) {
    std::set<Index3> cubes;
    for (const Vec3& place : places) {
        const Index3 cube = cubeAt(place, level);
        for (int n = 0; n < 27; ++n) {
            cubes.insert({cube[0] + n % 3 - 1, cube[1] + n / 3 % 3 - 1, cube[2] + n / 9 - 1});
        }
    }
    return cubes;
}

void LocalTolerances::add(const std::vector<Vec3>& places) {
    for (const Index3& cube : cubesAround(places)) ++added_[cube];
}

void LocalTolerances::addCrossings(const std::vector<Vec3>& places) {
    crossings_.merge(cubesAround(places));
}

void LocalTolerances::freeze(const std::vector<Vec3>& places, int level) {
    frozen_[level].merge(cubesAround(places, level));
}

bool LocalTolerances::isFrozen(const Vec3& index) const {
    return std::any_of(frozen_.begin(), frozen_.end(), [&](const auto& level) {
        return level.second.contains(cubeAt(index, level.first));
    });
}

/// How often the square is halved.
std::uint8_t LocalTolerances::halvingsAt(const Index3& cube) const {
    const auto at = added_.find(cube);
    return at == added_.end() ? 0 : kHalvings[std::min(at->second, kHalvings.size() - 1)];
}

void LocalTolerances::apply(const MetricFrame& frame, Sample& sample) const {
    if (added_.empty() && crossings_.empty()) return;
    const Index3 cube = cubeAt(frame.toIndex(sample.point()));
    sample.halvings =
        std::max<std::uint8_t>(sample.halvings, halvingsAt(cube)) & Sample::kMostHalvings;
    if (crossings_.contains(cube)) sample.clearance = 0;
}

void LocalTolerances::apply(const MetricFrame& frame, std::vector<Sample>& samples) const {
    for (Sample& sample : samples) apply(frame, sample);
}

}  // namespace adaptiso::detail
