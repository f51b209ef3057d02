#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// How far points reach along the 13 directions of a cube's edges and diagonals.
class Reach {
public:
    void add(const Vec3& p) {
        for (std::size_t n = 0; n < kDirections.size(); ++n) {
            const double along = dot(kDirections[n], p);
            low_[n] = std::min(low_[n], along);
            high_[n] = std::max(high_[n], along);
        }
    }

    /// The farthest of all directions; 0 without a point.
    double spanMm() const {
        double spanMm = 0;
        for (std::size_t n = 0; n < kDirections.size(); ++n) {
            spanMm = std::max(spanMm, (high_[n] - low_[n]) / norm(kDirections[n]));
        }
        return spanMm;
    }

    /// The middle of the box around all points. \pre there is a point
    Vec3 middleMm() const {
        return {0.5 * (low_[0] + high_[0]), 0.5 * (low_[1] + high_[1]), 0.5 * (low_[2] + high_[2])};
    }

private:
    static constexpr std::array<Vec3, 13> kDirections{{{1, 0, 0},
                                                       {0, 1, 0},
                                                       {0, 0, 1},
                                                       {1, 1, 0},
                                                       {1, -1, 0},
                                                       {1, 0, 1},
                                                       {1, 0, -1},
                                                       {0, 1, 1},
                                                       {0, 1, -1},
                                                       {1, 1, 1},
                                                       {1, 1, -1},
                                                       {1, -1, 1},
                                                       {-1, 1, 1}}};
    static constexpr std::array<double, 13> filled(double value) {
        std::array<double, 13> all{};
        all.fill(value);
        return all;
    }
    std::array<double, 13> low_ = filled(std::numeric_limits<double>::infinity()),
                           high_ = filled(-std::numeric_limits<double>::infinity());
};

}  // namespace adaptiso
