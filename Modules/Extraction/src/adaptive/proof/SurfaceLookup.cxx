#include "adaptive/proof/SurfaceLookup.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

std::int64_t floorOf(double x) {
    return static_cast<std::int64_t>(std::floor(x));
}

}  // namespace

std::pair<Index3, Index3> SurfaceLookup::placesNear(std::uint64_t t) const {
    const Corners corners = cornersOf(t);
    const BoundingBox box =
        boxOf({latticeOf(corners[0]), latticeOf(corners[1]), latticeOf(corners[2])});
    std::pair<Index3, Index3> places;
    for (int a = 0; a < 3; ++a) {
        places.first[a] = floorOf((box.minimum[a] - kMargin) / Brick::kSide);
        places.second[a] = floorOf((box.maximum[a] + kMargin) / Brick::kSide);
    }
    return places;
}

SurfaceLookup::SurfaceLookup(const SimplifiedSurface& surface, const Bricks& bricks,
                             const MetricFrame& frame)
    : surface_(surface), bricks_(bricks), frame_(frame) {
    parallelInvoke([&] { walkable_.assign(surface.points, surface.triangles); },
                   [&] {
                       ofBrick_.assign(bricks_.count(), [&](const auto& give) {
                           for (SurfaceState::Number t = 0; t < triangleCount(); ++t) {
                               forEachBrickNear(t, [&](std::int64_t b) { give(b, t); });
                           }
                       });
                   });
}

void SurfaceLookup::update(std::vector<SurfaceState::Number> changed) {
    const auto before = static_cast<SurfaceState::Number>(walkable_.triangleCount()),
               now = static_cast<SurfaceState::Number>(triangleCount());
    // triangles may have come and gone meanwhile
    std::erase_if(changed, [&](SurfaceState::Number t) { return t >= std::min(before, now); });
    for (SurfaceState::Number t = std::min(before, now); t < std::max(before, now); ++t) {
        changed.push_back(t);
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    std::vector<std::uint8_t> isChanged(std::max(before, now), 0);
    for (const SurfaceState::Number t : changed) isChanged[t] = 1;
    Buckets<SurfaceState::Number> ofBrick(bricks_.count(), [&](const auto& give) {
        for (std::int64_t b = 0; b < bricks_.count(); ++b) {
            for (const SurfaceState::Number t : this->ofBrick(b)) {
                if (isChanged[t] == 0) give(b, t);
            }
        }
        for (const SurfaceState::Number t : changed) {
            if (t < now) forEachBrickNear(t, [&](std::int64_t b) { give(b, t); });
        }
    });
    for (std::size_t b = 0; b < ofBrick.count(); ++b) {
        const auto triangles = ofBrick.of(b);
        const auto added = std::is_sorted_until(triangles.begin(), triangles.end());
        std::inplace_merge(triangles.begin(), added, triangles.end());
    }
    ofBrick_ = std::move(ofBrick);
    walkable_.update(surface_.points, surface_.triangles, changed);
    treeIsBuilt_ = std::make_unique<std::once_flag>();
}

const TriangleTree& SurfaceLookup::tree() const {
    std::call_once(*treeIsBuilt_, [&] {
        // while it waits for its own tasks a thread must not take one that needs the tree
        isolated([&] { tree_ = TriangleTree(view()); });
    });
    return tree_;
}

std::int64_t SurfaceLookup::brickFor(const Vec3& lattice) const {
    Index3 place;
    for (int a = 0; a < 3; ++a) place[a] = floorOf(lattice[a] / Brick::kSide);
    const std::int64_t own = bricks_.at(place);
    if (own != Bricks::kNone) return own;
    std::int64_t best = Bricks::kNone;
    for (int n = 0; n < 27; ++n) {
        const std::int64_t other =
            bricks_.at({place[0] + n % 3 - 1, place[1] + n / 3 % 3 - 1, place[2] + n / 9 - 1});
        if (other == Bricks::kNone || !isNear(bricks_[other], lattice)) continue;
        if (best == Bricks::kNone || other < best) best = other;
    }
    return best;
}

bool SurfaceLookup::isNear(const Brick& brick, const Vec3& lattice) {
    for (int a = 0; a < 3; ++a) {
        const double p = lattice[a] - static_cast<double>(brick.low[a]);
        if (p < -kMargin || p > Brick::kSide + kMargin) return false;
    }
    return true;
}

bool SurfaceLookup::isSmall(const Corners& piece) const {
    const BoundingBox box = boxOf({latticeOf(piece[0]), latticeOf(piece[1]), latticeOf(piece[2])});
    const Vec3 side = box.size();
    return std::max({side.x, side.y, side.z}) <= 1;
}

bool SurfaceLookup::isWithinReach(std::int64_t brick, const Corners& piece) const {
    return std::all_of(piece.begin(), piece.end(), [&](const Vec3& corner) {
        return isNear(bricks_[brick], latticeOf(corner));
    });
}

}  // namespace adaptiso::detail
