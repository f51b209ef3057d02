#include <array>
#include <cmath>
#include <cstdint>

#include "Run.h"

namespace adaptiso::simplifier {

PointTransfer::PointTransfer(const TriangleMesh& from, const TriangleMesh& to)
    : from_(from), to_(to), places_(nearestPoints(to, from)) {}

VertexId PointTransfer::nearestCorner(std::size_t point) const {
    const Triangle& corners = from_.triangles[places_[point].triangle];
    VertexId best = corners[0];
    for (const VertexId corner : corners) {
        const auto away = [&](VertexId v) {
            return squaredNorm(from_.points[v] - to_.points[point]);
        };
        if (away(corner) < away(best)) best = corner;
    }
    return best;
}

template <class T>
std::vector<T> PointTransfer::mixed(const std::vector<T>& values, std::size_t columns) const {
    std::vector<T> result(places_.size() * columns);
    for (std::size_t p = 0; p < places_.size(); ++p) {
        const Triangle& corners = from_.triangles[places_[p].triangle];
        for (std::size_t column = 0; column < columns; ++column) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = places_[p].weight[c];
                if (weight != 0) sum += weight * values[corners[c] * columns + column];
            }
            result[p * columns + column] = static_cast<T>(sum);
        }
    }
    return result;
}

std::vector<Color> PointTransfer::mixed(const std::vector<Color>& colors) const {
    std::vector<Color> result(places_.size());
    for (std::size_t p = 0; p < places_.size(); ++p) {
        const Triangle& corners = from_.triangles[places_[p].triangle];
        for (std::size_t shade = 0; shade < 3; ++shade) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                sum += places_[p].weight[c] * colors[corners[c]][shade];
            }
            result[p][shade] = static_cast<std::uint8_t>(std::lround(sum));
        }
    }
    return result;
}

template <class T>
std::vector<T> PointTransfer::nearest(const std::vector<T>& values, std::size_t columns) const {
    std::vector<T> result(places_.size() * columns);
    for (std::size_t p = 0; p < places_.size(); ++p) {
        const auto corner = static_cast<std::size_t>(nearestCorner(p));
        for (std::size_t column = 0; column < columns; ++column) {
            result[p * columns + column] = values[corner * columns + column];
        }
    }
    return result;
}

PointArray PointTransfer::operator()(const PointArray& array) const {
    const auto columns = static_cast<std::size_t>(array.components);
    PointArray taken{array.name, {}, array.components};
    if (const auto* const colors = std::get_if<std::vector<Color>>(&array.values)) {
        taken.values = mixed(*colors);
    } else if (const auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
        taken.values = mixed(*numbers, columns);
    } else {
        taken.values = nearest(std::get<std::vector<std::int64_t>>(array.values), columns);
    }
    return taken;
}

PointData PointTransfer::operator()(const PointData& data) const {
    PointData taken = data;
    taken.points = std::ssize(to_.points);
    for (PointValues& array : taken.arrays) {
        const auto columns = static_cast<std::size_t>(array.columns);
        if (const auto* const numbers = std::get_if<std::vector<float>>(&array.values)) {
            array.values = mixed(*numbers, columns);
        } else {
            array.values = nearest(std::get<std::vector<std::int32_t>>(array.values), columns);
        }
    }
    return taken;
}

}  // namespace adaptiso::simplifier
