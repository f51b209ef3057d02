#include "adaptive/rounds/TightPlaces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "adaptive/Parameters.h"

namespace adaptiso::detail {

Index3 TightPlaces::cubeAt(const Vec3& place, int level) {
    const double side = std::ldexp(kTightCube, level);
    Index3 cube;
    for (int a = 0; a < 3; ++a) cube[a] = static_cast<std::int64_t>(std::floor(place[a] / side));
    return cube;
}

std::set<Index3> TightPlaces::cubesAround(const std::vector<Vec3>& places, int level) {
    std::set<Index3> cubes;
    for (const Vec3& place : places) {
        const Index3 cube = cubeAt(place, level);
        for (int n = 0; n < 27; ++n) {
            cubes.insert({cube[0] + n % 3 - 1, cube[1] + n / 3 % 3 - 1, cube[2] + n / 9 - 1});
        }
    }
    return cubes;
}

void TightPlaces::add(const std::vector<Vec3>& places) {
    for (const Index3& cube : cubesAround(places)) ++tightness_[cube];
}

void TightPlaces::addCrossings(const std::vector<Vec3>& places) {
    crossings_.merge(cubesAround(places));
}

void TightPlaces::freeze(const std::vector<Vec3>& places, int level) {
    frozen_[level].merge(cubesAround(places, level));
}

bool TightPlaces::isFrozen(const Vec3& index) const {
    return std::any_of(frozen_.begin(), frozen_.end(), [&](const auto& level) {
        return level.second.contains(cubeAt(index, level.first));
    });
}

/// How often the square is halved.
std::uint8_t TightPlaces::tightnessAt(const Index3& cube) const {
    const auto at = tightness_.find(cube);
    return at == tightness_.end() ? 0 : kHalvings[std::min(at->second, kHalvings.size() - 1)];
}

void TightPlaces::apply(const MetricFrame& frame, Sample& sample) const {
    if (tightness_.empty() && crossings_.empty()) return;
    const Index3 cube = cubeAt(frame.toIndex(sample.point()));
    sample.tightness =
        std::max<std::uint8_t>(sample.tightness, tightnessAt(cube)) & Sample::kMostHalvings;
    if (crossings_.contains(cube)) sample.room = 0;
}

void TightPlaces::apply(const MetricFrame& frame, std::vector<Sample>& samples) const {
    for (Sample& sample : samples) apply(frame, sample);
}

}  // namespace adaptiso::detail
