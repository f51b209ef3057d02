#include "filling/LoopTriangulation.h"

#include <limits>

namespace adaptiso::detail {
namespace {

/// Least cosine between an ear's normal and the surface's: 15, 30, 60, 90 and 180 degrees.
constexpr std::array<double, 5> kLeastCosine{0.9659, 0.8660, 0.5, 0.0, -2.0};

/// Squared sine below which an ear counts as flat: its corners lie on a line.
constexpr double kFlatEar = 1e-12;

struct Ear {
    double cosine;        ///< between its normal and the surface's
    double chordSquared;  ///< length of the edge that cuts it off
    bool chordOnFace;
    bool isFlat;
};

Ear measureEar(const SpatialCorner& a, const SpatialCorner& b, const SpatialCorner& c) {
    const Vec3 area = areaVector2(a.point, b.point, c.point);
    const double sides = squaredNorm(b.point - a.point) * squaredNorm(c.point - b.point);
    return {dot(normalized(area), normalized(a.normal + b.normal + c.normal)),
            squaredNorm(c.point - a.point), (a.faces & c.faces) != 0,
            squaredNorm(area) <= kFlatEar * sides};
}

}  // namespace

void triangulateLoop(std::span<const SpatialCorner> loop, std::vector<LocalTriangle>& out) {
    std::vector<std::uint32_t> rest(loop.size());
    for (std::uint32_t i = 0; i < rest.size(); ++i) rest[i] = i;
    std::vector<Ear> ears(loop.size());
    const auto measure = [&](std::size_t i) {
        const std::size_t n = rest.size();
        ears[i] = measureEar(loop[rest[(i + n - 1) % n]], loop[rest[i]], loop[rest[(i + 1) % n]]);
    };
    for (std::size_t i = 0; i < rest.size(); ++i) measure(i);

    while (rest.size() > 3) {
        const std::size_t n = rest.size();
        std::size_t best = n;
        for (int pass = 0; pass < 3 && best == n; ++pass) {  // also on a face, then also flat
            for (const double least : kLeastCosine) {
                double shortest = std::numeric_limits<double>::infinity();
                for (std::size_t i = 0; i < n; ++i) {
                    const Ear& ear = ears[i];
                    if ((ear.isFlat && pass < 2) || (ear.chordOnFace && pass < 1)) continue;
                    // NaN can't be: crossings are finite, and normalized(0) is 0
                    if (ear.cosine < least || ear.chordSquared >= shortest) continue;
                    shortest = ear.chordSquared;
                    best = i;
                }
                if (best < n) break;
            }
        }
        out.push_back({rest[(best + n - 1) % n], rest[best], rest[(best + 1) % n]});
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
        ears.erase(ears.begin() + static_cast<std::ptrdiff_t>(best));
        measure(best == 0 ? n - 2 : best - 1);
        measure(best == n - 1 ? 0 : best);
    }
    out.push_back({rest[0], rest[1], rest[2]});
}

}  // namespace adaptiso::detail
