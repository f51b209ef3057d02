#include "adaptive/proof/ErrorBound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = 1 << 14;

/// The largest distance of a sample to the triangle that it is assigned to: no bound can be less.
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

/// Calls f(piece) for the parts of a triangle that no brick has in its reach.
template <class F>
void forEachFarPiece(const SurfaceLookup& lookup, const Corners& piece, const F& f) {
    const std::int64_t brick =
        lookup.brickFor(lookup.latticeOf((1.0 / 3) * (piece[0] + piece[1] + piece[2])));
    if (lookup.isSmall(piece)) {
        if (brick == Bricks::kNone) f(piece);
        return;
    }
    if (brick != Bricks::kNone && lookup.isWithinReach(brick, piece)) return;
    for (const Corners& part : quarter(piece)) forEachFarPiece(lookup, part, f);
}

}  // namespace

ErrorProof::ErrorProof(const LatticeSampler& sampler, const Bricks& bricks,
                       const MetricFrame& frame, double limitMm)
    : sampler_(sampler), bricks_(bricks), frame_(frame), limitMm_(limitMm), numbers_(bricks) {}

ErrorBound ErrorProof::prove(const SimplifiedSurface& surface) {
    whole_ = WholeBricks(surface, bricks_, frame_);
    if (whole_.areAll()) {
        lookup_.reset();
        return {};
    }
    lookup_ = std::make_unique<SurfaceLookup>(surface, bricks_, frame_);
    // bounds are as tight as the largest sample's distance, or as a hundredth of a voxel
    enoughMm_ = std::min(
        limitMm_, std::max(largestSampleDistance(surface, *lookup_), 0.01 * frame_.narrowestMm()));
    provedMm_ = 0;
    return prove(surface, ProofScope());
}

ErrorBound ErrorProof::proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes) {
    if (!lookup_) return prove(surface);
    lookup_->update(changes.triangles);
    whole_ = WholeBricks(surface, bricks_, frame_);
    return prove(surface, scopeOf(*lookup_, changes));
}

ErrorBound ErrorProof::prove(const SimplifiedSurface& surface, const ProofScope& scope) {
    std::vector<BrickBound> results(bricks_.count());
    PerThread<BrickProof> proofs([&] {
        return BrickProof(surface, *lookup_, whole_, sampler_, scope, numbers_, enoughMm_,
                          limitMm_);
    });
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
    bound.beyondLimit = beyond;
    if (!(provedArea >= (1 - 1e-9) * areaOf(*lookup_, scope))) {
        includeFarPieces(surface, *lookup_, bound);
        lookup_.reset();
    } else {
        remember(std::move(beyond));
    }
    return bound;
}

/// Bounds the distance of what is too far from every brick for one to answer for it, by single
/// points of the full-resolution surface: loosely.
void ErrorProof::includeFarPieces(const SimplifiedSurface& surface, const SurfaceLookup& lookup,
                                  ErrorBound& bound) const {
    std::vector<Vec3> points;
    const std::size_t step = 1 + surface.samples.size() / kFarSamples;
    for (std::size_t s = 0; s < surface.samples.size(); s += step) {
        points.push_back(surface.samples[s].point());
    }
    std::vector<double> largest(lookup.triangleCount(), 0);
    parallelForPieces(std::ssize(largest), 1, [&](std::int64_t t, std::int64_t) {
        forEachFarPiece(lookup, lookup.cornersOf(t), [&](const Corners& piece) {
            double least = std::numeric_limits<double>::infinity();
            for (const Vec3& p : points) {
                least =
                    std::min(least, std::max({squaredNorm(piece[0] - p), squaredNorm(piece[1] - p),
                                              squaredNorm(piece[2] - p)}));
            }
            largest[t] = std::max(largest[t], least);
        });
    });
    for (SurfaceState::Number t = 0; t < largest.size(); ++t) {
        if (largest[t] == 0) continue;
        constexpr double kRounding = 1 + 1e-6;  // samples are kept in single precision
        const double mm = kRounding * std::sqrt(largest[t]);
        bound.largestMm = std::max(bound.largestMm, mm);
        const Corners c = lookup.cornersOf(t);
        const Vec3 middle = (1.0 / 3) * (c[0] + c[1] + c[2]);
        if (mm > limitMm_) bound.beyondLimit.push_back({middle, middle, t, false});
    }
}

void ErrorProof::remember(std::vector<PlaceBeyond> beyond) {
    isWithin_.assign(lookup_->triangleCount(), 1);
    for (const PlaceBeyond& place : beyond) {
        if (!place.isOfFine) isWithin_[place.triangle] = 0;
    }
    beyond_ = std::move(beyond);
}

/// What is to be proved: the new triangles, and the full-resolution surface near those that came or
/// went and where it lay beyond the limit. What was farther from these than the proved distance
/// lies as near another triangle.
ProofScope ErrorProof::scopeOf(const SurfaceLookup& lookup, const SurfaceChanges& changes) const {
    const double reachMm = std::min(limitMm_, provedMm_);
    ProofScope scope;
    scope.isKnown = isWithin_;
    scope.isKnown.resize(lookup.triangleCount(), 0);
    scope.blocks.assign(bricks_.grid().blockCount(), false);
    for (const std::uint64_t t : changes.triangles) {
        if (t < scope.isKnown.size()) scope.isKnown[t] = 0;
    }
    for (std::uint64_t t = 0; t < scope.isKnown.size(); ++t) {
        if (scope.isKnown[t] == 0) markAround(lookup.cornersOf(t), reachMm, scope);
    }
    for (const Corners& corners : changes.before) markAround(corners, reachMm, scope);
    markBeyond(scope);
    return scope;
}

void ErrorProof::markBeyond(ProofScope& scope) const {
    for (const PlaceBeyond& place : beyond_) {
        markAround({place.point(), place.point(), place.point()}, 0, scope);
    }
}

/// Marks the blocks that reach within a distance of a triangle.
void ErrorProof::markAround(const Corners& triangle, double distanceMm, ProofScope& scope) const {
    constexpr double kWall = 1e-3;  // of a voxel: on a block's wall both blocks are meant
    const BlockGrid& grid = bricks_.grid();
    BoundingBox box = boxOf(
        {frame_.toIndex(triangle[0]), frame_.toIndex(triangle[1]), frame_.toIndex(triangle[2])});
    box.widen(distanceMm / frame_.narrowestMm() + kWall);
    Index3 first, last;
    for (int a = 0; a < 3; ++a) {
        const auto blockAt = [&](double index) {
            const double lattice = std::clamp(index + static_cast<double>(grid.offset), 0.0,
                                              static_cast<double>(grid.blocks[a] * grid.blockSize));
            return static_cast<std::int64_t>(lattice) / grid.blockSize;
        };
        first[a] = blockAt(box.minimum[a]);
        last[a] = std::min(blockAt(box.maximum[a]), grid.blocks[a] - 1);
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
