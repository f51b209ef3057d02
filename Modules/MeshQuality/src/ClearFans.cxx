#include "adaptiso/MeshQuality/ClearFans.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

/// A triangle is upright when its normal's cosine to the direction is larger than this. A fan with
/// more triangles than that counts as not clear.
constexpr double kLeastCosine = 0.02;
constexpr std::int64_t kMostTriangles = 24;

/// Puts the triangles around a vertex into one ring.
/// \return false where they are none
bool sortRound(std::span<std::array<std::uint32_t, 2>> sectors) {
    for (auto next = sectors.begin() + 1; next != sectors.end(); ++next) {
        const auto found = std::find_if(next, sectors.end(),
                                        [&](const auto& s) { return s[0] == (*(next - 1))[1]; });
        if (found == sectors.end()) return false;
        std::swap(*next, *found);
    }
    return sectors.back()[1] == sectors.front()[0];
}

/// \param spokes  to the corners of a ring, seen from the vertex
bool goRoundOnce(std::span<const Vec3> spokes) {
    const auto next = [&](std::size_t i) { return spokes[i + 1 < spokes.size() ? i + 1 : 0]; };
    std::array<Vec3, kMostTriangles> area2;
    Vec3 axis;
    for (std::size_t i = 0; i < spokes.size(); ++i) {
        area2[i] = cross(spokes[i], next(i));
        axis += area2[i];
    }
    const Vec3 across =
        std::abs(axis.x) < std::abs(axis.y) ? cross(axis, {1, 0, 0}) : cross(axis, {0, 1, 0});
    const double least = kLeastCosine * norm(axis);
    int rounds = 0;  // how often the sectors pass the direction from which `across` grows
    for (std::size_t i = 0; i < spokes.size(); ++i) {
        const double upright = dot(area2[i], axis);
        if (!(upright > 0 && upright * upright > least * least * squaredNorm(area2[i]))) {
            return false;
        }
        if (dot(spokes[i], across) < 0 && dot(next(i), across) >= 0) ++rounds;
    }
    return rounds == 1;
}

}  // namespace

void ClearFans::prove(std::span<const Vec3> points, Sectors sectors) {
    constexpr std::int64_t kPiece = 4096;
    const auto isClear = [&](std::int64_t v) {
        const std::span<Sector> ring = sectors.of(static_cast<std::size_t>(v));
        const std::int64_t count = std::ssize(ring);
        if (count < 3 || count > kMostTriangles || !sortRound(ring)) return false;
        std::array<Vec3, kMostTriangles> spokes;
        for (std::int64_t i = 0; i < count; ++i) spokes[i] = points[ring[i][0]] - points[v];
        return goRoundOnce({spokes.data(), ring.size()});
    };
    parallelForPieces(std::ssize(isClear_), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            isClear_[v] = static_cast<std::uint8_t>(isClear(v));
        }
    });
}

}  // namespace adaptiso
