#include "adaptive/bricks/SheetClearance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptive/Parameters.h"
#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {
namespace {

struct Place {
    std::array<float, 3> point, normal;
};

/// Points by cubes of the lattice, a voxel wide, hashed: those of other cubes that come with a
/// cube's are farther than all that is asked for.
class Cubes {
public:
    Cubes(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
          const MetricFrame& frame)
        : frame_(frame), mask_(std::bit_ceil(4 * points.size() + 4) - 1) {
        std::vector<std::uint32_t> slots;
        slots.reserve(points.size());
        for (const Vec3& p : points) slots.push_back(static_cast<std::uint32_t>(slotOf(cubeAt(p))));
        places_.assign(mask_ + 1, [&](const auto& give) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                give(slots[i], placeOf(points[i], normals[i]));
            }
        });
    }

    static Place placeOf(const Vec3& p, const Vec3& normal) {
        return {Sample::positionOf(p), Sample::positionOf(normalized(normal))};
    }

    /// Squared distance to the nearest point of another sheet, or `most`.
    float nearestOther(const Vec3& point, const Vec3& normal, float most) const {
        const Place own = placeOf(point, normal);
        const Index3 cube = cubeAt(point);
        const auto lookAtOne = [&](const Place& other) {
            float squared = 0, cosine = 0;
            for (int a = 0; a < 3; ++a) {
                const float d = other.point[a] - own.point[a];
                squared += d * d;
                cosine += other.normal[a] * own.normal[a];
            }
            most = cosine < kOtherSheetCosine ? std::min(most, squared) : most;
        };
        const auto lookAt = [&](std::span<const Place> others) {
            // thousands, as where all triangles share a vertex: some of them tell as much
            constexpr std::size_t kMany = 1024, kSome = 256;
            if (others.size() <= kMany) {
                for (const Place& other : others) lookAtOne(other);
                return;
            }
            const std::size_t step = others.size() / kSome + 1;
            for (std::size_t n = 0; n < others.size(); n += step) lookAtOne(others[n]);
        };
        for (int n = 0; n < 9; ++n) {
            const std::size_t begin =
                                  slotOf({cube[0] - 1, cube[1] + n % 3 - 1, cube[2] + n / 3 - 1}),
                              end = begin + 3, slots = mask_ + 1;
            lookAt(places_.of(begin, std::min(end, slots)));
            if (end > slots) lookAt(places_.of(0, end - slots));
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
    /// Cubes in a row have slots in a row.
    std::size_t slotOf(const Index3& c) const {
        const auto at = [&](int a) { return static_cast<std::size_t>(c[a]); };
        return (at(0) + 40503 * at(1) + 2654435761 * at(2)) & mask_;
    }

    const MetricFrame& frame_;
    std::size_t mask_;
    Buckets<Place, std::uint32_t> places_;
};

}  // namespace

void SheetClearance::fillIn(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                            const MetricFrame& frame, std::vector<std::uint8_t>& clearance) {
    if (std::all_of(clearance.begin(), clearance.end(), [](std::uint8_t r) { return r == kAlone; }))
        return;
    const Cubes cubes(points, normals, frame);
    const auto unit = static_cast<float>(frame.narrowestMm());
    constexpr std::int64_t kPiece = 1 << 12;
    const auto fill = [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) {
            if (clearance[i] == kAlone) continue;
            clearance[i] =
                of(std::sqrt(cubes.nearestOther(points[i], normals[i], unit * unit)), frame);
        }
    };
    // a brick's: its thread must not begin another brick meanwhile
    isolated([&] { parallelForPieces(std::ssize(points), kPiece, fill); });
}

}  // namespace adaptiso::detail
