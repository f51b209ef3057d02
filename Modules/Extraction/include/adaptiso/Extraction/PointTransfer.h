#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Simplify.h"

namespace adaptiso {

/// Takes values at the points of a surface to those of another that lies near it: n points on m.
///
/// Arrays hold `columns` values a point, one point after the other: m before, n after.
class PointTransfer {
public:
    /// Both must outlive it. \pre as nearestPoints()
    PointTransfer(const TriangleMesh& from, const TriangleMesh& to)
        : from_(from), to_(to), places_(nearestPoints(to, from)) {}

    std::size_t size() const { return places_.size(); }  ///< n

    /// The corners of the triangle of `from` that is nearest to a point of `to`.
    const Triangle& corners(std::size_t point) const {
        return from_.triangles[places_[point].triangle];
    }
    /// Barycentric weights of these corners at the nearest place.
    const std::array<double, 3>& weights(std::size_t point) const { return places_[point].weight; }

    /// The nearest of these corners, the first of several.
    VertexId nearestCorner(std::size_t point) const {
        VertexId best = corners(point)[0];
        for (const VertexId corner : corners(point)) {
            if (awayFrom(point, corner) < awayFrom(point, best)) best = corner;
        }
        return best;
    }

    /// Values mixed by weights(); whole numbers are rounded. One that is not a number counts only
    /// where its corner has a weight.
    template <class T>
    std::vector<T> mixed(const T* values, std::size_t columns) const {
        std::vector<T> result;
        result.reserve(size() * columns);
        for (std::size_t p = 0; p < size(); ++p) {
            for (std::size_t column = 0; column < columns; ++column) {
                double sum = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const double weight = weights(p)[c];
                    if (weight != 0) sum += weight * values[corners(p)[c] * columns + column];
                }
                if constexpr (std::is_integral_v<T>) sum = std::round(sum);
                result.push_back(static_cast<T>(sum));
            }
        }
        return result;
    }

    /// Values of nearestCorner(), as labels need.
    template <class T>
    std::vector<T> nearest(const T* values, std::size_t columns) const {
        std::vector<T> result;
        result.reserve(size() * columns);
        for (std::size_t p = 0; p < size(); ++p) {
            const T* const begin = values + static_cast<std::size_t>(nearestCorner(p)) * columns;
            result.insert(result.end(), begin, begin + columns);
        }
        return result;
    }

private:
    double awayFrom(std::size_t point, VertexId corner) const {
        return squaredNorm(from_.points[corner] - to_.points[point]);
    }

    const TriangleMesh& from_;
    const TriangleMesh& to_;
    std::vector<SurfacePoint> places_;  ///< of the points of `to` on `from`
};

}  // namespace adaptiso
