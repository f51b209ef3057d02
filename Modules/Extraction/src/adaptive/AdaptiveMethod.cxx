#include "adaptive/AdaptiveMethod.h"

#include <algorithm>
#include <limits>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
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
                   const ProgressCallback& progress, bool mends)
        : full_(full),
          progress_(progress),
          mends_(mends),
          frame_(full.frame()),
          wanted_{options.maxTriangles, options.reduction},
          leavesNoise_(options.leavesNoise.value_or(!options.maxErrorMm && !wanted_.isGiven())),
          boundMm_(boundOf(options)) {
        shape_.leastAngleDeg = options.minAngleDeg;
    }

    AdaptiveResult run() {
        for (;;) {
            if (auto result = runWithinBound()) return *std::move(result);
            if (!hasTighterBound()) break;
            boundMm_ = std::max(defaultBoundMm(), kTighterBound * *boundMm_);
        }
        throw InternalError(
            "the adaptive method could not prove its mesh sound and within the bound; nothing is "
            "returned");
    }

private:
    /// \return  nothing where it could not be proved, or too much of the full surface came back
    std::optional<AdaptiveResult> runWithinBound() {
        const int mostRuns = mends_ ? kMostRuns : 1;
        for (int run = 0; run < mostRuns; ++run) {
            report(work_.runs, 0);
            ++work_.runs;
            Attempt attempt = simplify(run > 0);
            report(work_.runs - 1, 0.6);
            mayUndo_ = mostUndone(attempt.surface, run + 1 == mostRuns);
            const std::int64_t triangles = attempt.surface.triangleCount();
            if (!keepsPromises(attempt)) continue;
            if (run + 1 < kMostRuns && !keepsCount(attempt.surface, triangles)) {
                fewer_ = std::max<std::int64_t>(0, attempt.surface.triangleCount() - triangles);
                continue;
            }
            report(work_.runs - 1, 1);
            return resultOf(attempt);
        }
        return std::nullopt;
    }

    /// Result of a run, and its proof.
    struct Attempt {
        SimplifiedSurface surface;
        DistanceProof proof;
        ErrorBound error{};
        /// Its triangles that cross others, or whose piece lies on the wrong side of another
        std::vector<std::int64_t> crossing{};
    };

    /// The surface is proved to lie within the bound, to cross nothing, and to have each piece on
    /// its side of the others. Single places where it does not are mended; what mending does not
    /// help is taken back to the full surface, farther and farther around.
    bool keepsPromises(Attempt& attempt) {
        attempt.error = attempt.proof.prove(attempt.surface);
        attempt.surface.returnFreedMemory();
        double reachMm = kUndoReach * frame_.narrowestMm();
        for (int n = 0; keepsDistances(attempt); ++n) {
            findCrossings(attempt);
            if (attempt.crossing.empty()) return true;
            if (mends_ && n < kMostMends && mendCrossings(attempt)) continue;
            if (!takeBack(attempt, cornersOf(attempt.surface, attempt.crossing), reachMm)) break;
        }
        return false;
    }

    /// After mending as many triangles are left as are wanted, or as were before.
    bool keepsCount(const SimplifiedSurface& surface, std::int64_t before) const {
        if (!wanted_.isGiven()) return true;
        const std::int64_t now = surface.triangleCount(),
                           wanted = std::max(before, wanted_.of(surface.fineTriangles));
        return now <= wanted &&
               static_cast<double>(now) >= (1 - kCountMissed) * static_cast<double>(before);
    }

    AdaptiveResult resultOf(Attempt& attempt) const {
        SimplifiedSurface& surface = attempt.surface;
        AdaptiveResult result;
        result.errorBoundMm = attempt.error.largestMm;
        if (wanted_.isGiven()) result.wantedTriangles = wanted_.of(surface.fineTriangles);
        result.tableTriangles = surface.tableTriangles;
        result.work = work_;
        result.work.trianglesKept = trianglesKept(surface);
        surface.forgetFull();
        surface.returnFreedMemory();
        result.mesh = full_.meshOf(surface);
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
        attempt.proof.rest();
        attempt.surface.returnFreedMemory();
        attempt.crossing = full_.crossingTriangles(attempt.surface, attempt.proof.isFine());
        if (attempt.crossing.empty()) attempt.crossing = full_.insideOut(attempt.surface);
    }

    /// Triangles are larger then, and so is all that comes of a place beyond it.
    bool isBoundLarge() const {
        return boundMm_ && *boundMm_ > kSheetDistance * frame_.narrowestMm();
    }
    bool isBeyond(const ErrorBound& error) const { return boundMm_ && error.largestMm > *boundMm_; }

    /// Mends places beyond the bound, and takes the simplification back around those that mending
    /// does not help; proves what was changed.
    bool keepsDistances(Attempt& attempt) {
        if (isBeyond(attempt.error)) mend(attempt);
        double reachMm = kUndoReach * frame_.narrowestMm();
        while (isBeyond(attempt.error)) {
            if (!takeBack(attempt, attempt.error.beyondLimit, reachMm)) return false;
            mend(attempt);
        }
        return true;
    }

    void mend(Attempt& attempt) {
        if (!mends_) return;
        SimplifiedSurface& surface = attempt.surface;
        SurfaceMender mender(surface, frame_, *boundMm_, full_.box());
        for (int idle = 0; isBeyond(attempt.error) && idle < kMostIdleMends;) {
            const std::size_t before = trianglesOf(attempt.error).size();
            const std::size_t mended = mender.mendDistances(attempt.error.beyondLimit);
            if (mended == 0) break;
            work_.placesMended += static_cast<std::int64_t>(mended);
            surface.returnFreedMemory();
            attempt.error = attempt.proof.proveAgain(surface, mender.takeChanges());
            const bool isLess = static_cast<double>(trianglesOf(attempt.error).size()) <
                                kMended * static_cast<double>(before);
            idle = isLess ? 0 : idle + 1;
        }
        mended_.insert(mended_.end(), mender.changedTriangles().begin(),
                       mender.changedTriangles().end());
    }

    /// Takes the simplification back around places, as far as anything comes of it, and proves what
    /// was changed. \param reachMm  doubled each time
    /// \return false where all of the surface is the full one already, or too much has come back
    bool takeBack(Attempt& attempt, const std::vector<PlaceBeyond>& places, double& reachMm) {
        if (!mends_ && ++takenBack_ > kMostTakenBack) return false;
        SimplifiedSurface& surface = attempt.surface;
        const std::ptrdiff_t points = std::ssize(surface.points);
        std::optional<SurfaceChanges> changes;
        while (!changes && !surface.heirs.empty() && reachMm <= 4 * full_.largestExtentMm()) {
            LocalUndo undo(full_.fineOf(surface), surface);
            changes = undo.around(mended_, places, reachMm, mayUndo_);
            if (undo.isTooMuch()) return false;
            reachMm *= 2;
        }
        if (!changes) return false;
        work_.verticesUndone += std::ssize(surface.points) - points;
        mayUndo_ -= std::ssize(surface.points) - points;
        attempt.error = attempt.proof.proveAgain(surface, *changes);
        return true;
    }

    double defaultBoundMm() const {
        return AdaptiveOptions::kDefaultMaxErrorVoxels * frame_.narrowestMm();
    }
    /// A surface within a tighter bound will do where too much of the full one came back.
    bool hasTighterBound() const { return mends_ && boundMm_ && *boundMm_ > defaultBoundMm(); }

    /// Vertices that may come back in this run. By a large bound a place can take more and more
    /// with it, where a run that keeps nearer has none.
    std::int64_t mostUndone(const SimplifiedSurface& surface, bool isLast) const {
        if (!hasTighterBound() && (isLast || !isBoundLarge())) return LocalUndo::kAny;
        return static_cast<std::int64_t>(kMostUndone * static_cast<double>(surface.points.size()));
    }

    /// Triangles with places beyond the bound, each once: some have hundreds of places.
    static std::vector<SurfaceState::Number> trianglesOf(const ErrorBound& error) {
        std::vector<SurfaceState::Number> triangles;
        for (const PlaceBeyond& place : error.beyondLimit) {
            if (place.triangle != PlaceBeyond::kNone) triangles.push_back(place.triangle);
        }
        std::sort(triangles.begin(), triangles.end());
        triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
        return triangles;
    }

    static std::vector<PlaceBeyond> cornersOf(const SurfaceState& surface,
                                              const std::vector<std::int64_t>& triangles) {
        std::vector<PlaceBeyond> corners;
        for (const std::int64_t t : triangles) {
            for (const std::uint64_t v : surface.triangles[t]) {
                corners.push_back({surface.points[v], surface.points[v]});
            }
        }
        return corners;
    }

    bool mendCrossings(Attempt& attempt) {
        SurfaceMender mender(attempt.surface, frame_, boundMm_.value_or(attempt.error.largestMm),
                             full_.box());
        const std::size_t mended = mender.mendCrossings(attempt.crossing, wanted_.isGiven());
        work_.placesMended += static_cast<std::int64_t>(mended);
        mended_.insert(mended_.end(), mender.changedTriangles().begin(),
                       mender.changedTriangles().end());
        if (mended > 0) {
            attempt.error = attempt.proof.proveAgain(attempt.surface, mender.takeChanges());
        }
        return mended > 0;
    }

    std::optional<double> boundOf(const AdaptiveOptions& adaptive) const {
        if (adaptive.maxErrorMm || wanted_.isGiven()) return adaptive.maxErrorMm;
        return defaultBoundMm();
    }

    void report(int run, double fraction) const {
        // later runs mend what the first could not prove: they come on top
        if (progress_) progress_(run == 0 ? "extract" : "refine", fraction);
    }

    /// \param isCareful  every star is proved
    PatchLimits limits(bool isCareful) const {
        const double sheetMm = kSheetDistance * frame_.narrowestMm();
        const double boundMm = boundMm_.value_or(kCountDistance * frame_.narrowestMm());
        PatchLimits limits;
        limits.shape = shape_;
        limits.leavesNoise = leavesNoise_;
        limits.box = full_.box();
        const double least = isCareful && isBoundLarge() ? kSlackPart : kLeastSlackPart;
        limits.maxDistanceMm =
            boundMm - std::max(least * boundMm,
                               std::min(kSlackVoxels * frame_.narrowestMm(), kSlackPart * boundMm));
        if (!mends_) limits.maxDistanceMm = std::min(limits.maxDistanceMm, kUnmended * boundMm);
        if (boundMm_) {
            limits.webMm = isBoundLarge() ? (isCareful ? 2 : 1) * kWidestWeb * frame_.narrowestMm()
                                          : kWeb * *boundMm_;
        }
        if (!wanted_.isGiven()) limits.maxFittedMm = kFitDistance * limits.maxDistanceMm;
        limits.provesAll = isCareful || limits.maxDistanceMm > sheetMm;
        limits.keepsHeirs = isCareful || boundMm_;
        return limits;
    }

    Attempt simplify(bool isCareful) {
        mended_.clear();
        Simplification simplification(full_, limits(isCareful));
        WantedCount wanted = wanted_;
        wanted.fewer = fewer_;
        // without a bound the count goes before closeness
        const double farthestMm = boundMm_ ? 0 : full_.largestExtentMm();
        SimplifiedSurface surface = wanted.isGiven() ? simplification.toCount(wanted, farthestMm)
                                                     : simplification.toLimits();
        const TriangleView fine = full_.fineOf(surface);
        return {std::move(surface),
                DistanceProof(fine, frame_, boundMm_.value_or(std::numeric_limits<double>::max()))};
    }

    const FullSurface& full_;
    const ProgressCallback& progress_;
    bool mends_;
    const MetricFrame& frame_;
    WantedCount wanted_;
    bool leavesNoise_;
    std::optional<double> boundMm_;
    StarLimits shape_;
    int takenBack_ = 0;         ///< times, where nothing is mended
    std::int64_t mayUndo_ = 0;  ///< below 0: too much has come back
    std::int64_t fewer_ = 0;    ///< triangles that a run aims below the wanted count
    AdaptiveWork work_;
    std::vector<SurfaceState::Triangle> mended_;  ///< of this run, before and after
};

}  // namespace

AdaptiveResult simplifyWithin(const FullSurface& full, const AdaptiveOptions& options,
                              const ProgressCallback& progress, bool mends) {
    return AdaptiveMethod(full, options, progress, mends).run();
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
