#include "adaptive/proof/SurfaceLookup.h"

#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace adaptiso::detail {
namespace {

std::int64_t floorOf(double x) {
    return static_cast<std::int64_t>(std::floor(x));
}

}  // namespace

std::pair<Index3, Index3> SurfaceLookup::placesNear(std::uint64_t t) const {
    const Corners corners = cornersOf(t);
    const CornerBox box =
        boxOf({latticeOf(corners[0]), latticeOf(corners[1]), latticeOf(corners[2])});
    std::pair<Index3, Index3> places;
    for (int a = 0; a < 3; ++a) {
        places.first[a] = floorOf((box.low[a] - kRoom) / Brick::kSide);
        places.second[a] = floorOf((box.high[a] + kRoom) / Brick::kSide);
    }
    return places;
}

SurfaceLookup::SurfaceLookup(const SimplifiedSurface& surface, const Bricks& bricks,
                             const MetricFrame& frame)
    : surface_(surface), bricks_(bricks), frame_(frame) {
    tbb::parallel_invoke([&] { walkable_.assign(surface.points, surface.triangles); },
                         [&] {
                             ofBrick_.assign(bricks_.count(), [&](const auto& give) {
                                 for (SurfaceState::Number t = 0; t < triangleCount(); ++t) {
                                     forEachBrickNear(t, [&](std::int64_t b) { give(b, t); });
                                 }
                             });
                         });
}

const TriangleTree& SurfaceLookup::tree() const {
    std::call_once(treeIsBuilt_, [&] {
        // while it waits for its own tasks a thread must not take one that asks for the tree
        tbb::this_task_arena::isolate([&] { tree_ = TriangleTree(view()); });
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
        if (p < -kRoom || p > Brick::kSide + kRoom) return false;
    }
    return true;
}

bool SurfaceLookup::isSmall(const Corners& piece) const {
    const CornerBox box = boxOf({latticeOf(piece[0]), latticeOf(piece[1]), latticeOf(piece[2])});
    const Vec3 side = box.high - box.low;
    return std::max({side.x, side.y, side.z}) <= 1;
}

bool SurfaceLookup::isWithinReach(std::int64_t brick, const Corners& piece) const {
    return std::all_of(piece.begin(), piece.end(), [&](const Vec3& corner) {
        return isNear(bricks_[brick], latticeOf(corner));
    });
}

}  // namespace adaptiso::detail
