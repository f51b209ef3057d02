#include "AdaptiveMethod.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../MeshRepair.h"
#include "CrossingProof.h"
#include "ErrorBound.h"
#include "Simplification.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

TriangleMesh toMesh(const SimplifiedSurface& surface, const ImageGeometry& geometry,
                    const MetricFrame& frame, const LatticeSampler& sampler) {
    TriangleMesh mesh;
    constexpr std::int64_t kPiece = 4096;
    mesh.points.resize(surface.points.size());
    mesh.normals.resize(surface.points.size());
    parallelForPieces(std::ssize(mesh.points), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            const Vec3 index = frame.toIndex(surface.points[v]);
            mesh.points[v] = geometry.toPhysical(index);
            mesh.normals[v] = toNormal(sampler.normalAt(index));
        }
    });
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
          boundMm_(boundOf(options.adaptive)),
          proof_(sampler, bricks, frame_, boundMm_.value_or(std::numeric_limits<double>::max())) {
        shape_.leastAngleDeg = options.adaptive.minAngleDeg;
    }

    Extraction run() {
        SimplifiedSurface surface;
        for (int run = 0; run < kMostRuns; ++run) {
            report(run, 0);
            unfitted_ = {};
            surface = simplify(std::move(surface));
            report(run, 0.6);
            ErrorBound error = proof_.prove(surface);
            if (isBeyond(error)) {
                tighten(error);
                if (run >= kFirstFreeze) {
                    freeze(indicesOf(error), run);
                } else if (halfway_ && hasStalled(error)) {
                    mendHalfway(surface);
                }
                continue;
            }
            if (!wanted_.isGiven()) error = fit(surface, error);
            report(run, 1);
            Extraction result;
            result.mesh = toMesh(surface, geometry_, frame_, sampler_);
            std::vector<Vec3> crossings = indicesOf(crossingPlaces(result.mesh));
            if (!crossings.empty() && undoFits(crossings, surface)) {
                error = proveFitted(surface);
                result.mesh = toMesh(surface, geometry_, frame_, sampler_);
                crossings = indicesOf(crossingPlaces(result.mesh));
            }
            if (!crossings.empty()) {
                proveAround(crossings);
                if (run >= kFirstFreeze) freeze(crossings, run);
                continue;
            }
            if (!options_.computeNormals) result.mesh.normals = {};
            result.statistics = statisticsOf(surface, error);
            return result;
        }
        throw InternalError(
            "extractSurface: the adaptive method could not prove its mesh sound and "
            "within the bound; nothing is returned");
    }

private:
    static constexpr int kMostRuns = 16, kMostMends = 6, kMostUndos = 6, kMostCrossedRuns = 3;
    /// What fails from this run on stays at full resolution, twice as far around with every run:
    /// in the last one all of it, if need be.
    static constexpr int kFirstFreeze = 6;
    /// Vertices are fitted within this part of the allowed distance, or no farther than they were:
    /// then few places are lost.
    static constexpr double kFitDistance = 0.75;
    /// Runs that leave more than this part of the places beyond the bound lead nowhere.
    static constexpr double kStalled = 0.25;
    /// Up to this distance (of the least one between planes of samples) single sheets are certain
    /// not to meet others: see isSingleSheet.
    static constexpr double kSheetVoxels = 0.5;
    /// What is tried first for a count without a bound: it leads to largest distances below half a
    /// voxel.
    static constexpr double kCountVoxels = 0.46;
    /// First allowed distance of samples: that much below the bound (in the least distance between
    /// planes of samples, and as a part of the bound), since points between samples may lie
    /// farther.
    static constexpr double kSlackVoxels = 0.05, kSlackPart = 0.3;

    /// The surface before its vertices were fitted.
    struct Unfitted {
        std::vector<Vec3> points;
        ErrorBound proved;
    };

    bool isBeyond(const ErrorBound& error) const { return boundMm_ && error.largestMm > *boundMm_; }

    /// Moves vertices to where they serve the mean distance best, if what is proved stays true.
    /// \return what is proved of the surface then
    ErrorBound fit(SimplifiedSurface& surface, const ErrorBound& proved) {
        PatchLimits closer = limits();
        closer.maxFittedMm = kFitDistance * closer.maxDistanceMm;
        unfitted_ = {surface.points, proved};
        Simplification(sampler_, bricks_, frame_, tight_, closer).fit(surface);
        return proveFitted(surface);
    }

    /// Where the bound is lost vertices go back to where they were.
    ErrorBound proveFitted(SimplifiedSurface& surface) {
        for (int undo = 0; undo < kMostUndos; ++undo) {
            ErrorBound error = proof_.prove(surface);
            if (!isBeyond(error)) return error;
            if (!undoFits(indicesOf(error), surface)) break;
        }
        surface.points = unfitted_.points;
        return unfitted_.proved;
    }

    /// \param places  continuous sample indices
    /// \return false when no vertex was fitted there
    bool undoFits(const std::vector<Vec3>& places, SimplifiedSurface& surface) const {
        if (unfitted_.points.empty()) return false;
        TightPlaces around;
        around.add(places);
        bool isUndone = false;
        for (std::size_t s = 0; s < surface.samples.size(); ++s) {
            if (!around.has(frame_, surface.samples[s])) continue;
            for (const std::uint64_t v : surface.triangles[surface.sampleTriangle[s]]) {
                if (surface.points[v] == unfitted_.points[v]) continue;
                surface.points[v] = unfitted_.points[v];
                isUndone = true;
            }
        }
        return isUndone;
    }

    std::vector<Vec3> indicesOf(const ErrorBound& error) const {
        std::vector<Vec3> indices;
        for (const Vec3& place : error.beyondLimit) indices.push_back(frame_.toIndex(place));
        return indices;
    }
    /// \param places  in physical space
    std::vector<Vec3> indicesOf(std::vector<Vec3> places) const {
        for (Vec3& place : places) place = geometry_.toIndex(place);
        return places;
    }

    /// Goes on with more proved: from halfway, and when that does not help from the beginning.
    /// \param crossings  continuous sample indices
    void proveAround(const std::vector<Vec3>& crossings) {
        tight_.addCrossings(crossings);
        if (++crossedRuns_ == kMostCrossedRuns) provesAll_ = true;
        if (crossedRuns_ > 1) halfway_.reset();
    }

    void freeze(const std::vector<Vec3>& places, int run) {
        tight_.freeze(places, run - kFirstFreeze);
        halfway_.reset();
    }

    ExtractionStatistics statisticsOf(const SimplifiedSurface& surface,
                                      const ErrorBound& error) const {
        ExtractionStatistics statistics;
        statistics.errorBoundMm = error.largestMm;
        if (wanted_.isGiven()) statistics.wantedTriangles = wanted_.of(surface.fineTriangles);
        statistics.marchingCubesTriangles = surface.tableTriangles;
        return statistics;
    }

    void tighten(const ErrorBound& error) { tight_.add(indicesOf(error)); }

    /// Hardly fewer places lie beyond the bound than after the run before: what they need may have
    /// been lost before halfway.
    bool hasStalled(const ErrorBound& error) {
        const auto count = static_cast<double>(error.beyondLimit.size());
        const bool isStalled = count > kStalled * beyond_;
        beyond_ = isStalled ? std::numeric_limits<double>::max() : count;
        return isStalled;
    }

    /// Makes what runs start from anew until that lies within the bound itself: at worst a run can
    /// then stay with it where it is tight.
    void mendHalfway(SimplifiedSurface& surface) {
        ErrorProof proof(sampler_, bricks_, frame_, *boundMm_);
        for (int mend = 0; mend < kMostMends; ++mend) {
            surface.state() = halfway_->state;
            const ErrorBound error = proof.prove(surface);
            if (error.largestMm <= *boundMm_) return;
            tighten(error);
            halfway_ =
                Simplification(sampler_, bricks_, frame_, tight_, limits()).toHalfway(surface);
        }
    }

    std::optional<double> boundOf(const AdaptiveOptions& adaptive) const {
        if (adaptive.maxErrorMm || wanted_.isGiven()) return adaptive.maxErrorMm;
        return AdaptiveOptions::kDefaultMaxErrorVoxels * frame_.narrowestMm();
    }

    void report(int run, double fraction) const {
        // later runs mend what the first could not prove: they come on top
        if (options_.progress) options_.progress(run == 0 ? "extract" : "refine", fraction);
    }

    PatchLimits limits() const {
        const double sheetMm = kSheetVoxels * frame_.narrowestMm();
        const double boundMm = boundMm_.value_or(kCountVoxels * frame_.narrowestMm());
        PatchLimits limits;
        limits.shape = shape_;
        limits.leavesNoise = !wanted_.isGiven();
        limits.maxDistanceMm =
            boundMm - std::min(kSlackVoxels * frame_.narrowestMm(), kSlackPart * boundMm);
        limits.provesAll = provesAll_ || limits.maxDistanceMm > sheetMm;
        return limits;
    }

    /// \param last  of the run before
    SimplifiedSurface simplify(SimplifiedSurface last) {
        Simplification simplification(sampler_, bricks_, frame_, tight_, limits());
        if (!wanted_.isGiven()) return simplification.toLimits(std::move(last), halfway_);
        if (boundMm_) return simplification.toCount(wanted_, 0);
        // without a bound the count goes before closeness
        const Index3& size = geometry_.size;
        const Vec3 extent =
            frame_.fromIndex({static_cast<double>(size[0]), static_cast<double>(size[1]),
                              static_cast<double>(size[2])});
        return simplification.toCount(wanted_, norm(extent));
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
    ErrorProof proof_;
    Unfitted unfitted_;
    double beyond_ = std::numeric_limits<double>::max();  ///< places after the last run
    int crossedRuns_ = 0;                                 ///< that left triangles that cross
    bool provesAll_ = false;                              ///< every star, everywhere
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
