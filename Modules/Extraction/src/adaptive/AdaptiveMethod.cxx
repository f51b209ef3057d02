#include "adaptive/AdaptiveMethod.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptive/Parameters.h"
#include "adaptive/mending/SurfaceMender.h"
#include "adaptive/proof/CrossingProof.h"
#include "adaptive/proof/ErrorBound.h"
#include "adaptive/rounds/Simplification.h"
#include "filling/MeshRepair.h"

namespace adaptiso::detail {
namespace {

/// Drops vertices without a triangle.
void dropUnusedVertices(TriangleMesh& mesh) {
    constexpr VertexId kUnused = -1;
    std::vector<VertexId> number(mesh.points.size(), kUnused);
    for (const auto& t : mesh.triangles) {
        for (const VertexId v : t) number[v] = 0;
    }
    VertexId used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = used++;
        mesh.points[number[v]] = mesh.points[v];
        mesh.normals[number[v]] = mesh.normals[v];
    }
    if (used == std::ssize(mesh.points)) return;
    mesh.points.resize(used);
    mesh.normals.resize(used);
    for (auto& t : mesh.triangles) {
        for (VertexId& v : t) v = number[v];
    }
}

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
    dropUnusedVertices(mesh);
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
            surface = simplify(std::move(surface));
            report(run, 0.6);
            ErrorBound error = proveAndMend(surface);
            if (isBeyond(error)) {
                tighten(error);
                if (run >= kFirstFreeze) {
                    freeze(indicesOf(error), run);
                } else if (halfway_ && hasStalled(error)) {
                    mendHalfway(surface);
                }
                continue;
            }
            report(run, 1);
            Extraction result;
            result.mesh = toMesh(surface, geometry_, frame_, sampler_);
            std::vector<std::int64_t> crossing = crossingTriangles(result.mesh);
            for (int mend = 0; mend < kMostMends && !crossing.empty(); ++mend) {
                const std::vector<Vec3> places = placesOf(crossing, result.mesh);
                if (!(mend == 0 && undoFits(places, surface)) &&
                    (wanted_.isGiven() || !mendCrossings(surface, crossing))) {
                    break;
                }
                error = proveAndMend(surface);
                result.mesh = toMesh(surface, geometry_, frame_, sampler_);
                crossing = crossingTriangles(result.mesh);
            }
            if (!crossing.empty() || isBeyond(error)) {
                std::vector<Vec3> places = placesOf(crossing, result.mesh);
                if (isBeyond(error)) tighten(error);
                if (!crossing.empty()) proveAround(places);
                const std::vector<Vec3> beyond = indicesOf(error);
                places.insert(places.end(), beyond.begin(), beyond.end());
                if (run >= kFirstFreeze) freeze(places, run);
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
    bool isBeyond(const ErrorBound& error) const { return boundMm_ && error.largestMm > *boundMm_; }

    /// What is proved of the surface, after places beyond the bound were mended.
    ErrorBound proveAndMend(SimplifiedSurface& surface) {
        ErrorBound error = proof_.prove(surface);
        if (wanted_.isGiven() || !isBeyond(error)) return error;
        SurfaceMender mender(surface, frame_, *boundMm_);
        for (int idle = 0; isBeyond(error) && idle < kMostIdleMends;) {
            const std::size_t before = error.beyondLimit.size();
            if (mender.mendDistances(error.beyondLimit) == 0) break;
            error = proof_.proveAgain(surface, mender.takeChanges());
            const bool isLess = static_cast<double>(error.beyondLimit.size()) <
                                kMended * static_cast<double>(before);
            idle = isLess ? 0 : idle + 1;
        }
        return error;
    }

    /// \param places  continuous sample indices
    /// \return false when no vertex was fitted there
    bool undoFits(const std::vector<Vec3>& places, SimplifiedSurface& surface) const {
        if (unfitted_.empty()) return false;
        TightPlaces around;
        around.add(places);
        bool isUndone = false;
        for (std::size_t s = 0; s < surface.samples.size(); ++s) {
            if (!around.has(frame_, surface.samples[s])) continue;
            for (const std::uint64_t v : surface.triangles[surface.sampleTriangle[s]]) {
                if (v >= unfitted_.size() || surface.points[v] == unfitted_[v]) continue;
                surface.points[v] = unfitted_[v];
                isUndone = true;
            }
        }
        return isUndone;
    }

    std::vector<Vec3> indicesOf(const ErrorBound& error) const {
        std::vector<Vec3> indices;
        for (const PlaceBeyond& place : error.beyondLimit) {
            indices.push_back(frame_.toIndex(place.point()));
        }
        return indices;
    }
    /// The middles of some triangles, as continuous sample indices.
    std::vector<Vec3> placesOf(const std::vector<std::int64_t>& triangles,
                               const TriangleMesh& mesh) const {
        std::vector<Vec3> places;
        for (const std::int64_t t : triangles) {
            const auto& [a, b, c] = mesh.triangles[t];
            places.push_back(
                geometry_.toIndex((1.0 / 3) * (mesh.points[a] + mesh.points[b] + mesh.points[c])));
        }
        return places;
    }

    bool mendCrossings(SimplifiedSurface& surface,
                       const std::vector<std::int64_t>& crossing) const {
        return SurfaceMender(surface, frame_, *boundMm_).mendCrossings(crossing) > 0;
    }

    /// Begins anew with more proved.
    /// \param crossings  continuous sample indices
    void proveAround(const std::vector<Vec3>& crossings) {
        tight_.addCrossings(crossings);
        if (++crossedRuns_ == kMostCrossedRuns) provesAll_ = true;
        halfway_.reset();
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
        const double sheetMm = kSheetDistance * frame_.narrowestMm();
        const double boundMm = boundMm_.value_or(kCountDistance * frame_.narrowestMm());
        PatchLimits limits;
        limits.shape = shape_;
        limits.leavesNoise = !wanted_.isGiven();
        limits.maxDistanceMm =
            boundMm - std::min(kSlackVoxels * frame_.narrowestMm(), kSlackPart * boundMm);
        limits.provesAll = provesAll_ || limits.maxDistanceMm > sheetMm;
        return limits;
    }

    /// Moves vertices to where they serve the mean distance best.
    void fit(SimplifiedSurface& surface) const {
        PatchLimits closer = limits();
        closer.maxFittedMm = kFitDistance * closer.maxDistanceMm;
        Simplification(sampler_, bricks_, frame_, tight_, closer).fit(surface);
    }

    /// \param last  of the run before
    SimplifiedSurface simplify(SimplifiedSurface last) {
        Simplification simplification(sampler_, bricks_, frame_, tight_, limits());
        if (!wanted_.isGiven()) {
            SimplifiedSurface surface = simplification.toLimits(std::move(last), halfway_);
            unfitted_ = surface.points;
            fit(surface);
            return surface;
        }
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
    std::vector<Vec3> unfitted_;                          ///< vertices before they were fitted
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
