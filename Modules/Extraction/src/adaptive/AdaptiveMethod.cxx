#include "adaptive/AdaptiveMethod.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptive/Parameters.h"
#include "adaptive/full/VolumeSurface.h"
#include "adaptive/mending/LocalUndo.h"
#include "adaptive/mending/SurfaceMender.h"
#include "adaptive/rounds/Simplification.h"

namespace adaptiso::detail {
namespace {

/// Runs the simplification until what it promises is proved.
class AdaptiveMethod {
public:
    AdaptiveMethod(const FullSurface& full, const AdaptiveOptions& options,
                   const ProgressCallback& progress)
        : full_(full),
          progress_(progress),
          frame_(full.frame()),
          wanted_{options.maxTriangles, options.reduction},
          boundMm_(boundOf(options)),
          proof_(full.proof(boundMm_.value_or(std::numeric_limits<double>::max()))) {
        shape_.leastAngleDeg = options.minAngleDeg;
    }

    AdaptiveResult run() {
        for (int run = 0; run < kMostRuns; ++run) {
            report(run, 0);
            ++work_.runs;
            Attempt attempt{simplify(), {}, {}, {}};
            report(run, 0.6);
            if (keepsPromises(attempt)) {
                report(run, 1);
                return resultOf(attempt);
            }
            learnFrom(attempt, run);
        }
        throw InternalError(
            "the adaptive method could not prove its mesh sound and within the bound; nothing is "
            "returned");
    }

private:
    /// What a run made, and what was found of it.
    struct Attempt {
        SimplifiedSurface surface;
        ErrorBound error;
        TriangleMesh mesh;  ///< of the surface; empty where that lies beyond the bound
        /// Its triangles that cross others, or whose piece lies on the wrong side of another
        std::vector<std::int64_t> crossing;
    };

    /// What later runs know of the ones before.
    struct Lessons {
        LocalTolerances tolerances;
        int crossedRuns = 0;     ///< that left triangles that cross
        bool provesAll = false;  ///< every star, everywhere
    };

    /// The surface is proved to lie within the bound, to cross nothing, and to have each piece on
    /// its side of the others. Single places where it is beyond or crosses are mended.
    bool keepsPromises(Attempt& attempt) {
        attempt.error = proof_->prove(attempt.surface);
        attempt.surface.returnFreedMemory();
        mendDistances(attempt);
        if (isBeyond(attempt.error)) return false;
        findCrossings(attempt);
        const std::int64_t triangles = attempt.surface.triangleCount();
        for (int mend = 0; mend < kMostMends && !attempt.crossing.empty(); ++mend) {
            auto changes = mendCrossings(attempt);
            if (!changes) changes = undoCrossings(attempt);
            if (!changes || !keepsCount(attempt.surface, triangles)) return false;
            attempt.error = proof_->proveAgain(attempt.surface, *changes);
            mendDistances(attempt);
            findCrossings(attempt);
        }
        if (!attempt.crossing.empty() || isBeyond(attempt.error)) return false;
        attempt.crossing = full_.insideOut(attempt.surface);
        return attempt.crossing.empty();
    }

    /// After mending as many triangles are left as are wanted, or as were before.
    bool keepsCount(const SimplifiedSurface& surface, std::int64_t before) const {
        if (!wanted_.isGiven()) return true;
        const std::int64_t now = surface.triangleCount(),
                           wanted = std::max(before, wanted_.of(surface.fineTriangles));
        return now <= wanted &&
               static_cast<double>(now) >= (1 - kCountMissed) * static_cast<double>(before);
    }

    /// Where promises were not kept the next run takes more care.
    void learnFrom(const Attempt& attempt, int run) {
        const std::vector<Vec3> beyond = indicesOf(attempt.error), crossings = placesOf(attempt);
        lessons_.tolerances.add(beyond);
        lessons_.tolerances.addCrossings(crossings);
        if (!crossings.empty() && ++lessons_.crossedRuns == kMostCrossedRuns) {
            lessons_.provesAll = true;
        }
        if (run < kFirstFreeze) return;
        lessons_.tolerances.freeze(beyond, run - kFirstFreeze);
        lessons_.tolerances.freeze(crossings, run - kFirstFreeze);
    }

    AdaptiveResult resultOf(Attempt& attempt) const {
        AdaptiveResult result;
        result.mesh = std::move(attempt.mesh);
        result.errorBoundMm = attempt.error.largestMm;
        if (wanted_.isGiven()) result.wantedTriangles = wanted_.of(attempt.surface.fineTriangles);
        result.tableTriangles = attempt.surface.tableTriangles;
        result.work = work_;
        result.work.trianglesKept = trianglesKept(attempt.surface);
        return result;
    }

    static std::int64_t trianglesKept(const SimplifiedSurface& surface) {
        return std::count_if(
            surface.triangles.begin(), surface.triangles.end(), [&](const auto& triangle) {
                return std::all_of(triangle.begin(), triangle.end(), [&](std::uint64_t v) {
                    return surface.states[v] == Patch::State::Final;
                });
            });
    }

    void findCrossings(Attempt& attempt) const {
        attempt.mesh = full_.meshOf(attempt.surface);
        attempt.crossing = crossingTriangles(attempt.mesh, full_.cellsOf(attempt.surface));
        full_.forgiveCrossings(attempt.mesh, attempt.crossing);
    }

    bool isBeyond(const ErrorBound& error) const { return boundMm_ && error.largestMm > *boundMm_; }

    /// Mends places beyond the bound, and proves what was changed.
    void mendDistances(Attempt& attempt) {
        if (wanted_.isGiven() || !isBeyond(attempt.error)) return;
        mend(attempt.surface, attempt.error);
        undo(attempt.surface, attempt.error);
    }

    /// \param error  what was proved; then what is
    void mend(SimplifiedSurface& surface, ErrorBound& error) {
        SurfaceMender mender(surface, frame_, *boundMm_, full_.box());
        for (int idle = 0; isBeyond(error) && idle < kMostIdleMends;) {
            const std::size_t before = trianglesOf(error).size();
            const std::size_t mended = mender.mendDistances(error.beyondLimit);
            if (mended == 0) break;
            work_.placesMended += static_cast<std::int64_t>(mended);
            surface.returnFreedMemory();
            error = proof_->proveAgain(surface, mender.takeChanges());
            const bool isLess = static_cast<double>(trianglesOf(error).size()) <
                                kMended * static_cast<double>(before);
            idle = isLess ? 0 : idle + 1;
        }
        keepChanged(mender);
    }

    void keepChanged(const SurfaceMender& mender) {
        const auto& changed = mender.changedTriangles();
        mended_.insert(mended_.end(), changed.begin(), changed.end());
    }

    /// Takes the simplification back around places that mending did not help.
    /// \param error  what was proved; then what is
    void undo(SimplifiedSurface& surface, ErrorBound& error) {
        double reachMm = kUndoReach * frame_.narrowestMm();
        for (int n = 0; n < kMostUndos && isBeyond(error); ++n) {
            const auto changes = undoAround(surface, trianglesOf(error), pointsOf(error), reachMm);
            if (changes) {
                error = proof_->proveAgain(surface, *changes);
                mend(surface, error);
            }
            reachMm *= 2;
        }
    }

    std::optional<SurfaceChanges> undoAround(SimplifiedSurface& surface,
                                             const std::vector<SurfaceState::Number>& triangles,
                                             const std::vector<Vec3>& places, double reachMm) {
        if (checkpoint_.points.empty()) return {};
        const std::ptrdiff_t points = std::ssize(surface.points);
        auto changes = LocalUndo(checkpoint_, surface).around(mended_, triangles, places, reachMm);
        work_.verticesUndone += std::ssize(surface.points) - points;
        return changes;
    }

    /// Of places beyond the bound, each once: some have hundreds of places.
    static std::vector<SurfaceState::Number> trianglesOf(const ErrorBound& error) {
        std::vector<SurfaceState::Number> triangles;
        for (const PlaceBeyond& place : error.beyondLimit) {
            if (place.triangle != PlaceBeyond::kNone) triangles.push_back(place.triangle);
        }
        std::sort(triangles.begin(), triangles.end());
        triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
        return triangles;
    }
    static std::vector<Vec3> pointsOf(const ErrorBound& error) {
        std::vector<Vec3> points;
        for (const PlaceBeyond& place : error.beyondLimit) points.push_back(place.point());
        return points;
    }

    std::vector<Vec3> indicesOf(const ErrorBound& error) const {
        std::vector<Vec3> indices;
        for (const Vec3& p : pointsOf(error)) indices.push_back(frame_.toIndex(p));
        return indices;
    }
    /// The middles of the triangles that cross, as continuous sample indices.
    std::vector<Vec3> placesOf(const Attempt& attempt) const {
        std::vector<Vec3> places;
        for (const std::int64_t t : attempt.crossing) {
            const auto& [a, b, c] = attempt.mesh.triangles[t];
            const std::vector<Vec3>& points = attempt.mesh.points;
            places.push_back(full_.indexOf((1.0 / 3) * (points[a] + points[b] + points[c])));
        }
        return places;
    }

    std::optional<SurfaceChanges> mendCrossings(Attempt& attempt) {
        SurfaceMender mender(attempt.surface, frame_, boundMm_.value_or(attempt.error.largestMm),
                             full_.box());
        const std::size_t mended = mender.mendCrossings(attempt.crossing, wanted_.isGiven());
        work_.placesMended += static_cast<std::int64_t>(mended);
        keepChanged(mender);
        if (mended == 0) return {};
        return mender.takeChanges();
    }

    /// Takes triangles that cross others back: where the simplification was taken back, its surface
    /// can cross that of the checkpoint.
    std::optional<SurfaceChanges> undoCrossings(Attempt& attempt) {
        const std::vector<SurfaceState::Number> triangles(attempt.crossing.begin(),
                                                          attempt.crossing.end());
        return undoAround(attempt.surface, triangles, {}, kUndoReach * frame_.narrowestMm());
    }

    std::optional<double> boundOf(const AdaptiveOptions& adaptive) const {
        if (adaptive.maxErrorMm || wanted_.isGiven()) return adaptive.maxErrorMm;
        return AdaptiveOptions::kDefaultMaxErrorVoxels * frame_.narrowestMm();
    }

    void report(int run, double fraction) const {
        // later runs mend what the first could not prove: they come on top
        if (progress_) progress_(run == 0 ? "extract" : "refine", fraction);
    }

    PatchLimits limits() const {
        const double sheetMm = kSheetDistance * frame_.narrowestMm();
        const double boundMm = boundMm_.value_or(kCountDistance * frame_.narrowestMm());
        PatchLimits limits;
        limits.shape = shape_;
        limits.leavesNoise = !wanted_.isGiven();
        limits.box = full_.box();
        limits.maxDistanceMm =
            boundMm - std::min(kSlackVoxels * frame_.narrowestMm(), kSlackPart * boundMm);
        if (boundMm_) limits.webMm = kWeb * *boundMm_;
        if (!wanted_.isGiven()) limits.maxFittedMm = kFitDistance * limits.maxDistanceMm;
        limits.provesAll = lessons_.provesAll || limits.maxDistanceMm > sheetMm;
        return limits;
    }

    SimplifiedSurface simplify() {
        checkpoint_ = {};
        Simplification simplification(full_, lessons_.tolerances, limits());
        if (!wanted_.isGiven()) {
            mended_.clear();
            return simplification.toLimits(checkpoint_);
        }
        if (boundMm_) return simplification.toCount(wanted_, 0);
        // without a bound the count goes before closeness
        return simplification.toCount(wanted_, full_.largestExtentMm());
    }

    const FullSurface& full_;
    const ProgressCallback& progress_;
    const MetricFrame& frame_;
    WantedCount wanted_;
    std::optional<double> boundMm_;
    StarLimits shape_;
    Lessons lessons_;
    SurfaceState checkpoint_;  ///< of this run; empty with a count
    AdaptiveWork work_;
    std::unique_ptr<DistanceProof> proof_;        ///< remembers what it proved last, to prove less
    std::vector<SurfaceState::Triangle> mended_;  ///< of this run, before and after
};

}  // namespace

void requireInRange(const AdaptiveOptions& options, const char* function) {
    const auto refuse = [&](const char* what) {
        throw InvalidInput(std::string(function) + ": " + what);
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

AdaptiveResult simplifyWithin(const FullSurface& full, const AdaptiveOptions& options,
                              const ProgressCallback& progress) {
    return AdaptiveMethod(full, options, progress).run();
}

Extraction extractAdaptive(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                           const ExtractionOptions& options) {
    const auto sampler = LatticeSampler::make(volume, options.isovalue, grid.border);
    const Bricks bricks(grid, query.blocks);
    Extraction result;
    result.statistics.blocksTotal = grid.blockCount();
    result.statistics.blocksActive = std::ssize(query.blocks);
    result.statistics.indexNodesVisited = query.nodesVisited;
    freeMemory(query.blocks);  // the bricks have them
    result.statistics.errorBoundMm = 0;
    if (bricks.count() > 0) {
        AdaptiveResult made = simplifyWithin(VolumeSurface(volume.geometry(), *sampler, bricks),
                                             options.adaptive, options.progress);
        result.mesh = std::move(made.mesh);
        if (!options.computeNormals) freeMemory(result.mesh.normals);
        result.statistics.errorBoundMm = made.errorBoundMm;
        result.statistics.wantedTriangles = made.wantedTriangles;
        result.statistics.adaptiveWork = made.work;
        result.statistics.marchingCubesTriangles = made.tableTriangles;
    }
    return result;
}

}  // namespace adaptiso::detail
