#include "AdaptiveMethod.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../MeshRepair.h"
#include "BrickRound.h"
#include "CrossingProof.h"
#include "ErrorBound.h"
#include "PatchRound.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace {

/// How many triangles are wanted: a number, or a share of those of the full surface to drop.
struct WantedCount {
    std::optional<std::int64_t> triangles;
    std::optional<double> reduction;

    bool isGiven() const { return triangles || reduction; }
    std::int64_t of(std::int64_t fineTriangles) const {
        std::int64_t count = std::min(triangles.value_or(fineTriangles), fineTriangles);
        if (reduction) {
            const double kept = (1 - *reduction) * static_cast<double>(fineTriangles);
            count = std::min(count, static_cast<std::int64_t>(kept));
        }
        return count;
    }
};

/// A surface after its first rounds, whose changes are too small to matter to the bound: when
/// places turn out to need more care, it can be gone on from here.
struct Halfway {
    SurfaceState state;
    int rounds = 0;
    double cost = 0;  ///< limit of its last round
};

/// One run of the simplification with fixed limits.
class Simplification {
public:
    Simplification(const LatticeSampler& sampler, const Bricks& bricks, const MetricFrame& frame,
                   const TightPlaces& tight, const PatchLimits& limits)
        : sampler_(sampler), bricks_(bricks), frame_(frame), tight_(tight), limits_(limits) {
        const double voxel = frame.voxelMm();
        costUnit_ = voxel * voxel * voxel * voxel;
    }

    /// As few triangles as the limits allow.
    /// \param last     of the run before, when that went through `halfway`
    /// \param halfway  where to start; is filled in when empty
    SimplifiedSurface toLimits(SimplifiedSurface last, std::optional<Halfway>& halfway) {
        SimplifiedSurface surface = std::move(last);
        if (halfway) {
            goOnFrom(*halfway, surface);
        } else {
            limits_.maxCost = kFirstCost * costUnit_;
            surface = simplifyBricks(sampler_, bricks_, frame_, tight_, limits_, nullptr);
        }
        for (const double cost : kCosts) {
            if (cost * costUnit_ <= limits_.maxCost) continue;
            if (!halfway && cost * costUnit_ > halfwayCost()) {
                halfway = Halfway{surface, rounds_, limits_.maxCost};
            }
            roundUpTo(cost * costUnit_, surface);
        }
        if (!halfway) halfway = Halfway{surface, rounds_, limits_.maxCost};
        for (int idle = 0; idle < 2;) {
            const std::int64_t before = surface.triangleCount();
            roundUpTo(std::numeric_limits<double>::max(), surface);
            idle = static_cast<double>(surface.triangleCount()) >=
                           kWorthwhile * static_cast<double>(before)
                       ? idle + 1
                       : 0;
        }
        fit(surface);
        return surface;
    }

    /// The wanted number of triangles, or as few as the limits allow.
    SimplifiedSurface toCount(const WantedCount& wanted) {
        CollapseCosts costs;
        double cost = kFirstCost;
        limits_.maxCost = cost * costUnit_;
        SimplifiedSurface surface =
            simplifyBricks(sampler_, bricks_, frame_, tight_, limits_, &costs);
        const std::int64_t target = wanted.of(surface.fineTriangles);
        if (surface.triangleCount() < target) {
            limits_.maxCost = costLimitFor(costs, (surface.fineTriangles - target) / 2);
            surface = simplifyBricks(sampler_, bricks_, frame_, tight_, limits_, nullptr);
        }
        for (int idle = 0; surface.triangleCount() > target && idle < 2;) {
            const std::int64_t before = surface.triangleCount();
            cost *= costStep(before, target);
            if (cost > kLastCost) cost = std::numeric_limits<double>::infinity();
            roundTowards(surface, target, cost);
            if (cost > kLastCost) idle = surface.triangleCount() == before ? idle + 1 : 0;
        }
        fit(surface);
        return surface;
    }

private:
    /// Cost limits, in voxels to the fourth: of the bricks' round, and above which there is none.
    static constexpr double kFirstCost = 1e-3, kLastCost = 10;
    /// Of the first rounds of toLimits().
    static constexpr std::array kCosts{3e-3, 1.8e-2, 0.108, 0.648, 3.888};
    /// Later runs start where changes are below this part of the square of the allowed distance.
    static constexpr double kHalfway = 2;
    /// A round that leaves more than this part of the triangles was hardly worth it.
    static constexpr double kWorthwhile = 0.99;
    /// Up to this part of the wanted count steps are large, and up to the other one middling.
    static constexpr std::int64_t kFar = 2;
    static constexpr double kNear = 1.4;

    /// Cuts in turn, so that what straddles one cut lies within the next.
    PatchCut nextCut() {
        ++rounds_;
        return {Brick::kSide, rounds_ % 2 == 1 ? Brick::kSide / 2 : 0};
    }

    /// How much the limit of cost may grow in a round.
    static double costStep(std::int64_t triangles, std::int64_t target) {
        if (triangles > kFar * target) return 16;
        return static_cast<double>(triangles) > kNear * static_cast<double>(target) ? 4 : 2;
    }

    void roundUpTo(double cost, SimplifiedSurface& surface) {
        limits_.triedCost = limits_.maxCost;
        limits_.maxCost = cost;
        simplifyPatches(surface, nextCut(), frame_, {limits_});
    }

    double halfwayCost() const {
        const double voxel = frame_.voxelMm();
        return kHalfway * voxel * voxel * limits_.maxDistanceMm * limits_.maxDistanceMm;
    }

    void goOnFrom(const Halfway& halfway, SimplifiedSurface& surface) {
        surface.state() = halfway.state;
        rounds_ = halfway.rounds;
        limits_.maxCost = halfway.cost;
        for (Sample& sample : surface.samples) {
            sample.tightness = tight_.tightnessAt(frame_.toIndex(sample.point()));
        }
    }

    /// A round up to a cost that does not lead below the target.
    void roundTowards(SimplifiedSurface& surface, std::int64_t target, double cost) {
        const std::int64_t wanted = (surface.triangleCount() - target + 1) / 2;
        limits_.maxCost = std::min(cost * costUnit_, std::numeric_limits<double>::max());
        if (surface.triangleCount() > kFar * target) {
            PatchWork work{limits_};
            work.mostCollapses = wanted;  // not reached but by a cost far too high
            simplifyPatches(surface, nextCut(), frame_, work);
        } else {
            landOn(wanted, surface);
        }
    }

    /// A round up to the limit of cost; where that makes more collapses than wanted it is undone,
    /// and done again with the cost that makes as many.
    void landOn(std::int64_t wanted, SimplifiedSurface& surface) {
        const PatchCut cut = nextCut();
        const double cost = limits_.maxCost;
        const SurfaceState before = surface;
        CollapseCosts costs;
        simplifyPatches(surface, cut, frame_, {limits_}, &costs);
        std::int64_t more = wanted - (before.triangleCount() - surface.triangleCount()) / 2;
        if (more >= 0) return;
        surface.state() = before;
        limits_.maxCost = costLimitFor(costs, wanted);
        PatchWork work{limits_};
        work.fits = true;
        simplifyPatches(surface, cut, frame_, work);
        isFitted_ = true;
        more = wanted - (before.triangleCount() - surface.triangleCount()) / 2;
        if (more > 0) {  // collapses of one cost
            limits_.maxCost = cost;
            PatchWork rest{limits_};
            rest.mostCollapses = more;
            simplifyPatches(surface, cut, frame_, rest);
        }
    }

    /// Twice, so that what straddles the cut has its turn as well.
    void fit(SimplifiedSurface& surface) {
        PatchWork work{limits_};
        work.collapses = false;
        work.fits = true;
        for (int i = isFitted_ ? 1 : 0; i < 2; ++i) {
            simplifyPatches(surface, nextCut(), frame_, work);
        }
    }

    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    const TightPlaces& tight_;
    PatchLimits limits_;
    double costUnit_;
    int rounds_ = 0;
    bool isFitted_ = false;  ///< by the last round
};

TriangleMesh toMesh(const SimplifiedSurface& surface, const ImageGeometry& geometry,
                    const MetricFrame& frame, const LatticeSampler& sampler) {
    TriangleMesh mesh;
    mesh.points.reserve(surface.points.size());
    mesh.normals.reserve(surface.points.size());
    for (const Vec3& p : surface.points) {
        const Vec3 index = frame.toIndex(p);
        mesh.points.push_back(geometry.toPhysical(index));
        mesh.normals.push_back(toNormal(sampler.normalAt(index)));
    }
    mesh.triangles.reserve(surface.triangles.size());
    const bool isMirrored = geometry.isMirrored();
    for (const auto& t : surface.triangles) {
        const auto id = [&](int c) { return static_cast<VertexId>(t[c]); };
        mesh.triangles.push_back(isMirrored ? adaptiso::Triangle{id(0), id(2), id(1)}
                                            : adaptiso::Triangle{id(0), id(1), id(2)});
    }
    completeNormals(mesh);
    return mesh;
}

/// Runs the simplification until what it promises is proved.
class AdaptiveMethod {
public:
    AdaptiveMethod(const VolumeView& volume, const LatticeSampler& sampler, const Bricks& bricks,
                   const ExtractionOptions& options)
        : geometry_(volume.geometry()),
          sampler_(sampler),
          bricks_(bricks),
          options_(options),
          frame_(geometry_),
          wanted_{options.adaptive.maxTriangles, options.adaptive.reduction},
          boundMm_(options.adaptive.maxErrorMm) {
        shape_.leastAngleDeg = options.adaptive.minAngleDeg;
        if (!boundMm_ && !wanted_.isGiven()) {
            boundMm_ = AdaptiveOptions::kDefaultMaxErrorVoxels * frame_.narrowestMm();
        }
    }

    Extraction run() {
        ErrorProof proof(sampler_, bricks_, frame_,
                         boundMm_.value_or(std::numeric_limits<double>::max()));
        SimplifiedSurface surface;
        for (int run = 0; run < kMostRuns; ++run) {
            report(run, 0);
            if (run > 0 && run % kRunsOfOneStart == 0) {
                halfway_.reset();
                share_ *= kLaterShare;
            }
            surface = run + 1 < kMostRuns ? simplify(std::move(surface)) : fullSurface();
            report(run, 0.6);
            const ErrorBound error = proof.prove(surface);
            report(run, 1);
            if (boundMm_ && error.largestMm > *boundMm_) {
                std::vector<Vec3> places;
                for (const Vec3& place : error.beyondLimit) places.push_back(frame_.toIndex(place));
                tight_.add(places);
                continue;
            }
            Extraction result;
            result.mesh = toMesh(surface, geometry_, frame_, sampler_);
            if (!crossesNothing(result.mesh)) {
                provesAll_ = true;
                halfway_.reset();
                continue;
            }
            if (!options_.computeNormals) result.mesh.normals = {};
            result.statistics.errorBoundMm = error.largestMm;
            result.statistics.marchingCubesTriangles = surface.tableTriangles;
            return result;
        }
        throw InternalError(
            "extractSurface: the adaptive method could not prove its mesh sound and "
            "within the bound; nothing is returned");
    }

private:
    static constexpr int kMostRuns = 12;
    /// As many runs start at what the first of them had halfway.
    static constexpr int kRunsOfOneStart = 6;
    /// Of the allowed distance, for each start after the first.
    static constexpr double kLaterShare = 0.7;
    /// Up to this distance (of the least one between planes of samples) single sheets are certain
    /// not to meet others: see isSingleSheet.
    static constexpr double kSheetVoxels = 0.5;
    /// First allowed distance of samples: that much below the bound (in the least distance between
    /// planes of samples, and as a part of the bound), since points between samples may lie
    /// farther.
    static constexpr double kSlackVoxels = 0.05, kSlackPart = 0.3;

    void report(int run, double fraction) const {
        // later runs mend what the first could not prove: they come on top
        if (options_.progress) options_.progress(run == 0 ? "extract" : "refine", fraction);
    }

    /// The marching cubes surface, which needs no simplification to be within any bound.
    SimplifiedSurface fullSurface() const {
        PatchLimits limits;
        limits.maxCost = -1;
        return simplifyBricks(sampler_, bricks_, frame_, tight_, limits, nullptr);
    }

    /// \param last  of the run before
    SimplifiedSurface simplify(SimplifiedSurface last) {
        const double sheetMm = kSheetVoxels * frame_.narrowestMm();
        PatchLimits limits;
        limits.shape = shape_;
        limits.leavesNoise = !wanted_.isGiven();
        const double boundMm = boundMm_.value_or(sheetMm);
        limits.maxDistanceMm = share_ * (boundMm - std::min(kSlackVoxels * frame_.narrowestMm(),
                                                            kSlackPart * boundMm));
        const Index3& size = geometry_.size;
        const double extentMm =
            norm(frame_.fromIndex({static_cast<double>(size[0]), static_cast<double>(size[1]),
                                   static_cast<double>(size[2])}));
        for (;; limits.maxDistanceMm *= 2) {
            limits.provesAll = provesAll_ || limits.maxDistanceMm > sheetMm;
            Simplification simplification(sampler_, bricks_, frame_, tight_, limits);
            if (!wanted_.isGiven()) return simplification.toLimits(std::move(last), halfway_);
            SimplifiedSurface surface = simplification.toCount(wanted_);
            const bool isThere = surface.triangleCount() <= wanted_.of(surface.fineTriangles) + 1;
            // without a bound the count goes before closeness
            if (isThere || boundMm_ || limits.maxDistanceMm > extentMm) return surface;
        }
    }

    const ImageGeometry& geometry_;
    const LatticeSampler& sampler_;
    const Bricks& bricks_;
    const ExtractionOptions& options_;
    MetricFrame frame_;
    WantedCount wanted_;
    std::optional<double> boundMm_;
    StarLimits shape_;
    TightPlaces tight_;
    std::optional<Halfway> halfway_;
    double share_ = 1;        ///< of the allowed distance
    bool provesAll_ = false;  ///< the last run left triangles that cross
};

void check(const AdaptiveOptions& options) {
    const auto refuse = [](const std::string& what) {
        throw InvalidInput("extractSurface: " + what);
    };
    if (options.maxErrorMm && !(*options.maxErrorMm > 0 && std::isfinite(*options.maxErrorMm))) {
        refuse("maxErrorMm must be a finite number above 0");
    }
    if (options.maxTriangles && *options.maxTriangles < 0) refuse("maxTriangles is below 0");
    if (options.reduction && !(*options.reduction >= 0 && *options.reduction <= 1)) {
        refuse("reduction must lie between 0 and 1");
    }
    if (!(options.minAngleDeg >= 0 && options.minAngleDeg <= 40)) {
        refuse("minAngleDeg must lie between 0 and 40");
    }
}

}  // namespace

Extraction extractAdaptive(const VolumeView& volume, const SpanSpaceIndex& index,
                           const ExtractionOptions& options) {
    check(options.adaptive);
    const BlockQuery query = index.blocksAt(options.isovalue);
    const auto sampler = LatticeSampler::make(volume, options.isovalue, index.grid().border);
    const Bricks bricks(index.grid(), query.blocks);
    Extraction result;
    if (bricks.count() > 0) {
        result = AdaptiveMethod(volume, *sampler, bricks, options).run();
    } else {
        result.statistics.errorBoundMm = 0;
    }
    result.statistics.blocksTotal = index.grid().blockCount();
    result.statistics.blocksActive = static_cast<std::int64_t>(query.blocks.size());
    result.statistics.indexNodesVisited = query.nodesVisited;
    return result;
}

}  // namespace adaptiso::detail
