#include "adaptive/bricks/SheetClearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

struct Place {
    std::array<float, 3> point, normal;
};

/// Points by cubes of the lattice, a voxel wide.
class Cubes {
public:
    Cubes(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
          const MetricFrame& frame)
        : frame_(frame) {
        std::vector<Index3> cubes;
        cubes.reserve(points.size());
        Index3 high{};
        for (const Vec3& p : points) {
            const Index3 cube = cubeAt(p);
            for (int a = 0; a < 3; ++a) {
                low_[a] = cubes.empty() ? cube[a] : std::min(low_[a], cube[a]);
                high[a] = cubes.empty() ? cube[a] : std::max(high[a], cube[a]);
            }
            cubes.push_back(cube);
        }
        for (int a = 0; a < 3; ++a) {  // an empty cube on every side
            --low_[a];
            count_[a] = high[a] - low_[a] + 2;
        }
        std::vector<Place> places(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) places[i] = placeOf(points[i], normals[i]);
        places_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]),
                       [&](const auto& give) {
                           for (std::size_t i = 0; i < points.size(); ++i) {
                               give(number(cubes[i]), places[i]);
                           }
                       });
    }

    static Place placeOf(const Vec3& p, const Vec3& normal) {
        const Vec3 n = normalized(normal);
        return {{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)}};
    }

    /// Squared distance to the nearest point of another sheet, or `most`.
    float nearestOther(const Vec3& point, const Vec3& normal, float most) const {
        const Place own = placeOf(point, normal);
        const Index3 cube = cubeAt(point);
        for (std::int64_t z = -1; z <= 1; ++z) {
            for (std::int64_t y = -1; y <= 1; ++y) {
                const std::size_t row = number({cube[0], cube[1] + y, cube[2] + z});
                for (const Place& other : places_.of(row - 1, row + 2)) {
                    float squared = 0, cosine = 0;
                    for (int a = 0; a < 3; ++a) {
                        const float d = other.point[a] - own.point[a];
                        squared += d * d;
                        cosine += other.normal[a] * own.normal[a];
                    }
                    most = cosine < kOtherSheetCosine ? std::min(most, squared) : most;
                }
            }
        }
        return most;
    }

private:
    Index3 cubeAt(const Vec3& p) const {
        const Vec3 index = frame_.toIndex(p);
        return {static_cast<std::int64_t>(std::floor(index.x)),
                static_cast<std::int64_t>(std::floor(index.y)),
                static_cast<std::int64_t>(std::floor(index.z))};
    }
    std::size_t number(const Index3& c) const {
        return static_cast<std::size_t>(
            c[0] - low_[0] + count_[0] * (c[1] - low_[1] + count_[1] * (c[2] - low_[2])));
    }

    const MetricFrame& frame_;
    Index3 low_{}, count_{};
    Buckets<Place, std::uint32_t> places_;
};

}  // namespace

void SheetClearance::fillIn(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                            const MetricFrame& frame, std::vector<std::uint8_t>& clearance) {
    if (std::all_of(clearance.begin(), clearance.end(), [](std::uint8_t r) { return r == kAlone; }))
        return;
    const Cubes cubes(points, normals, frame);
    const auto unit = static_cast<float>(frame.narrowestMm());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (clearance[i] == kAlone) continue;
        clearance[i] = of(std::sqrt(cubes.nearestOther(points[i], normals[i], unit * unit)), frame);
    }
}

}  // namespace adaptiso::detail
