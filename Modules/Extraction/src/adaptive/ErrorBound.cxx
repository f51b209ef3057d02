#include "ErrorBound.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr double kBoundless = std::numeric_limits<double>::max();
constexpr std::int64_t kPiece = 1 << 14;

/// The largest distance of a sample to the triangle that stands for it: no bound can be less.
double largestSampleDistance(const SimplifiedSurface& surface, const SurfaceLookup& lookup) {
    const auto count = static_cast<std::int64_t>(surface.samples.size());
    std::vector<double> largest((count + kPiece - 1) / kPiece, 0);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t s = begin; s < end; ++s) {
            largest[begin / kPiece] =
                std::max(largest[begin / kPiece],
                         squaredDistanceToTriangle(surface.samples[s].point(),
                                                   lookup.cornersOf(surface.sampleTriangle[s])));
        }
    });
    double result = 0;
    for (const double d : largest) result = std::max(result, d);
    return std::sqrt(result);
}

bool isBefore(const Corners& a, const Corners& b) {
    for (int c = 0; c < 3; ++c) {
        for (int axis = 0; axis < 3; ++axis) {
            if (a[c][axis] != b[c][axis]) return a[c][axis] < b[c][axis];
        }
    }
    return false;
}

/// Of the triangles that are to be proved.
double areaOf(const SurfaceLookup& lookup, const ProofScope& scope) {
    double area = 0;
    for (std::uint64_t t = 0; t < lookup.triangleCount(); ++t) {
        if (scope.isProved(t)) continue;
        const Corners c = lookup.cornersOf(t);
        area += 0.5 * norm(areaVector2(c[0], c[1], c[2]));
    }
    return area;
}

}  // namespace

ErrorProof::ErrorProof(const LatticeSampler& sampler, const Bricks& bricks,
                       const MetricFrame& frame, double limitMm)
    : sampler_(sampler), bricks_(bricks), frame_(frame), limitMm_(limitMm) {}

ErrorBound ErrorProof::prove(const SimplifiedSurface& surface) {
    const SurfaceLookup lookup(surface, bricks_, frame_);
    const ProofScope scope = scopeOf(lookup);
    if (known_.empty()) provedMm_ = 0;
    // bounds are as tight as the largest sample's distance; below a hundredth of a voxel none cares
    const double enough = std::min(
        limitMm_, std::max(largestSampleDistance(surface, lookup), 0.01 * frame_.narrowestMm()));
    std::vector<BrickBound> results(bricks_.count());
    tbb::enumerable_thread_specific<BrickProof> proofs(
        [&] { return BrickProof(surface, lookup, sampler_, scope, enough, limitMm_); });
    parallelForPieces(bricks_.count(), 1,
                      [&](std::int64_t b, std::int64_t) { results[b] = proofs.local().prove(b); });
    double provedArea = 0, farthestMm = 0;
    std::vector<PlaceBeyond> beyond;
    for (const BrickBound& result : results) {
        provedMm_ = std::max(provedMm_, result.provedMm);
        farthestMm = std::max(farthestMm, result.farthestMm);
        beyond.insert(beyond.end(), result.beyondLimit.begin(), result.beyondLimit.end());
        provedArea += result.provedArea;
    }
    ErrorBound bound;
    bound.largestMm = std::max(provedMm_, farthestMm);
    for (const PlaceBeyond& place : beyond) bound.beyondLimit.push_back(place.point);
    known_.clear();
    if (!(provedArea >= (1 - 1e-9) * areaOf(lookup, scope))) {
        bound.largestMm = kBoundless;  // far from every brick
    } else if (limitMm_ < kBoundless) {
        remember(lookup, std::move(beyond));
    }
    return bound;
}

void ErrorProof::remember(const SurfaceLookup& lookup, std::vector<PlaceBeyond> beyond) {
    std::vector<bool> isBeyond(lookup.triangleCount(), false);
    for (const PlaceBeyond& place : beyond) {
        if (place.triangle != PlaceBeyond::kNone) isBeyond[place.triangle] = true;
    }
    for (std::uint64_t t = 0; t < lookup.triangleCount(); ++t) {
        if (!isBeyond[t]) known_.push_back(lookup.cornersOf(t));
    }
    tbb::parallel_sort(known_.begin(), known_.end(), isBefore);
    beyond_ = std::move(beyond);
}

/// What is to be proved: the new triangles, and the full-resolution surface near those that came or
/// went and where it lay beyond the limit.
ProofScope ErrorProof::scopeOf(const SurfaceLookup& lookup) const {
    ProofScope scope;
    if (known_.empty()) return scope;
    const auto count = static_cast<std::int64_t>(lookup.triangleCount());
    scope.isKnown.assign(count, 0);
    scope.blocks.assign(bricks_.grid().blockCount(), false);
    std::vector<std::uint8_t> isStillThere(known_.size(), 0);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const Corners corners = lookup.cornersOf(t);
            const auto at = std::lower_bound(known_.begin(), known_.end(), corners, isBefore);
            if (at == known_.end() || *at != corners) continue;
            isStillThere[at - known_.begin()] = 1;
            scope.isKnown[t] = 1;
        }
    });
    for (std::int64_t t = 0; t < count; ++t) {
        if (scope.isKnown[t] == 0) markAround(lookup.cornersOf(t), limitMm_, scope);
    }
    for (std::size_t i = 0; i < known_.size(); ++i) {
        if (isStillThere[i] == 0) markAround(known_[i], limitMm_, scope);
    }
    for (const PlaceBeyond& place : beyond_) {
        markAround({place.point, place.point, place.point}, 0, scope);
    }
    return scope;
}

/// Marks the blocks that reach within a distance of a triangle.
void ErrorProof::markAround(const Corners& triangle, double distanceMm, ProofScope& scope) const {
    constexpr double kWall = 1e-3;  // of a voxel: on a block's wall both blocks are meant
    const BlockGrid& grid = bricks_.grid();
    CornerBox box = boxOf(
        {frame_.toIndex(triangle[0]), frame_.toIndex(triangle[1]), frame_.toIndex(triangle[2])});
    box.widen(distanceMm / frame_.narrowestMm() + kWall);
    Index3 first, last;
    for (int a = 0; a < 3; ++a) {
        const auto blockAt = [&](double index) {
            const double lattice = std::clamp(index + static_cast<double>(grid.offset), 0.0,
                                              static_cast<double>(grid.blocks[a] * grid.blockSize));
            return static_cast<std::int64_t>(lattice) / grid.blockSize;
        };
        first[a] = blockAt(box.low[a]);
        last[a] = std::min(blockAt(box.high[a]), grid.blocks[a] - 1);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
        for (std::int64_t y = first[1]; y <= last[1]; ++y) {
            for (std::int64_t x = first[0]; x <= last[0]; ++x) {
                scope.blocks[x + grid.blocks[0] * (y + grid.blocks[1] * z)] = true;
            }
        }
    }
}

}  // namespace adaptiso::detail
