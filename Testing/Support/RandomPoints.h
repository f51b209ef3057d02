#pragma once

#include <random>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::testing {

/// In a cube around the origin.
inline Vec3 randomPoint(std::mt19937& random, double halfSide = 1) {
    std::uniform_real_distribution<double> uniform(-halfSide, halfSide);
    return {uniform(random), uniform(random), uniform(random)};
}

}  // namespace adaptiso::testing
