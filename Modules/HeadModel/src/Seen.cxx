#include "adaptiso/HeadModel/Seen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace adaptiso {
namespace {

using Cell = std::array<std::int64_t, 3>;

Cell cellOf(const Vec3& p) {
    return {static_cast<std::int64_t>(std::floor(p.x / kFarFromSeenMm)),
            static_cast<std::int64_t>(std::floor(p.y / kFarFromSeenMm)),
            static_cast<std::int64_t>(std::floor(p.z / kFarFromSeenMm))};
}

/// Places by cubes as wide as the farthest look: 27 of them hold all that is near.
class Places {
public:
    explicit Places(const std::vector<Vec3>& places) {
        for (const Vec3& p : places) cells_[cellOf(p)].push_back(p);
    }
    double distanceMm(const Vec3& p) const {
        const Cell middle = cellOf(p);
        double least = kFarFromSeenMm * kFarFromSeenMm;
        for (std::int64_t n = 0; n < 27; ++n) {
            const auto found = cells_.find(
                {middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
            if (found == cells_.end()) continue;
            for (const Vec3& q : found->second) least = std::min(least, squaredNorm(q - p));
        }
        return std::sqrt(least);
    }

private:
    std::map<Cell, std::vector<Vec3>> cells_;
};

}  // namespace

SeenSurface seenOf(const TriangleMesh& surface, const std::vector<Vec3>& placesMm) {
    const Places places(placesMm);
    SeenSurface seen;
    for (const Vec3& p : surface.points) seen.distanceMm.push_back(places.distanceMm(p));
    double all = 0, near = 0;
    for (const Triangle& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        const double area = norm(areaVector2(a, b, c)) / 2;
        all += area;
        for (const VertexId v : t) {
            if (seen.distanceMm[v] <= kSeenWithinMm) near += area / 3;
        }
    }
    seen.share = all > 0 ? near / all : 0;
    return seen;
}

}  // namespace adaptiso
