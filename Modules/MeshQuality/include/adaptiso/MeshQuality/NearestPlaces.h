#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// How many of the distances found may be larger than the truth.
struct RoughDistances {
    std::int64_t rough = 0;  ///< by a hundredth at most
    std::int64_t open = 0;   ///< by more

    void operator+=(const RoughDistances& more) {
        rough += more.rough;
        open += more.open;
    }
};

/// A point that is not searched for, and one near it in number that is.
struct StandIn {
    std::int64_t point, like;
};

/// Finds the place of a surface that is nearest to each of many points, in parallel.
///
/// By the tree; where its boxes do not tell triangles apart, as near a vertex of thousands of
/// needles, by boxes along the triangles' own axes. A point that is about as far from thousands of
/// triangles, as the centre of a sphere, has no more than some 200 of them looked at on average:
/// what it finds may then be a hundredth farther than the nearest. Where boxes of any direction do
/// not tell triangles apart, as where thousands cross each other, either no more than 512 are
/// looked at, and what is found is the nearest of these; or few points are searched for, exactly.
/// Of points that are open 2^24 triangles are looked at in all, 8 for each at least: where pieces
/// of 4,096 points that are evenly spread are in vain, the others are not tried.
/// \param pointOf   of a number below `count`; empty: is left out
/// \param take      take(number, nearest), from any thread; may come twice, the last counts
/// \param areNear   points that follow each other are near each other, most of them: saves time.
///                  Of triangles equally near, another may be found.
/// \param standIns  null: all points are answered. Else no point is `open`: those that would be are
///                  searched for exactly, evenly spread, as many as looking at 256 triangles for
///                  each would cost; gets the others
/// \pre  `tree` is of `mesh`, which has a triangle with finite corners, and fewer than 2^32 points
///       \throws InvalidInput where it has more
/// Cost: O(log T) a point. The same input gives the same answers, whatever the number of threads.
RoughDistances findNearestPlaces(const TriangleMesh& mesh, const AabbTree& tree, std::int64_t count,
                                 const std::function<std::optional<Vec3>(std::int64_t)>& pointOf,
                                 const std::function<void(std::int64_t, const ClosestPoint&)>& take,
                                 bool areNear = true, std::vector<StandIn>* standIns = nullptr);

}  // namespace adaptiso
