#include "ErrorBound.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The largest distance of a sample to the triangle that stands for it: no bound can be less.
double largestSampleDistance(const SimplifiedSurface& surface, const SurfaceLookup& lookup) {
    constexpr std::int64_t kPiece = 1 << 14;
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

/// The triangles that a surface has and another one has not, or not in the same place.
std::vector<std::uint64_t> changedTriangles(const SurfaceLookup& surface,
                                            const SurfaceLookup& other) {
    std::vector<std::uint64_t> changed;
    for (std::uint64_t t = 0; t < surface.triangleCount(); ++t) {
        if (t >= other.triangleCount() || surface.cornersOf(t) != other.cornersOf(t)) {
            changed.push_back(t);
        }
    }
    return changed;
}

}  // namespace

ErrorBound ErrorProof::prove(const SimplifiedSurface& surface) {
    auto lookup = std::make_unique<SurfaceLookup>(surface, bricks_, frame_);
    std::vector<std::uint8_t> isNew(bricks_.count(), lookup_ ? 0 : 1);
    if (lookup_) {
        const auto mark = [&](const SurfaceLookup& of, const SurfaceLookup& other) {
            for (const std::uint64_t t : changedTriangles(of, other)) {
                of.forEachBrickNear(t, [&](std::int64_t b) { isNew[b] = 1; });
            }
        };
        mark(*lookup, *lookup_);
        mark(*lookup_, *lookup);
    }
    lookup_ = std::move(lookup);
    results_.resize(bricks_.count());
    // bounds are as tight as the largest sample's distance; below a hundredth of a voxel none cares
    const double enough = std::min(
        limitMm_, std::max(largestSampleDistance(surface, *lookup_), 0.01 * frame_.narrowestMm()));
    tbb::enumerable_thread_specific<BrickProof> proofs(
        [&] { return BrickProof(surface, *lookup_, sampler_, enough, limitMm_); });
    parallelForPieces(bricks_.count(), 1, [&](std::int64_t b, std::int64_t) {
        if (isNew[b] != 0) results_[b] = proofs.local().prove(b);
    });
    double area = 0, provedArea = 0;
    for (std::uint64_t t = 0; t < lookup_->triangleCount(); ++t) {
        const Corners c = lookup_->cornersOf(t);
        area += 0.5 * norm(areaVector2(c[0], c[1], c[2]));
    }
    ErrorBound bound;
    for (const BrickBound& result : results_) {
        bound.fromFineMm = std::max(bound.fromFineMm, result.fromFineMm);
        bound.toFineMm = std::max(bound.toFineMm, result.toFineMm);
        bound.beyondLimit.insert(bound.beyondLimit.end(), result.beyondLimit.begin(),
                                 result.beyondLimit.end());
        provedArea += result.provedArea;
    }
    if (!(provedArea >= (1 - 1e-9) * area)) bound.toFineMm = kInfinity;  // far from every brick
    return bound;
}

}  // namespace adaptiso::detail
