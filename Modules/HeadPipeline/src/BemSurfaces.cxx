#include "adaptiso/HeadPipeline/BemSurfaces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/HeadPipeline/BemChecks.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/HeadPipeline/BemSources.h"
#include "adaptiso/HeadPipeline/BemSpongyBone.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kDefaultVertices = 2562;
constexpr double kFitMm = 0.5;
/// Files keep floats: a gap must not fall short by their rounding (3e-5 mm at 500 mm).
constexpr double kRoundingMm = 1e-4;

/// The thinnest of four or five layers, the CSF, decides how short edges are: adaptive lengths,
/// scaled until the whole model has no more vertices than solvers take. What flat triangles do to
/// the layers' thickness cancels in part where surfaces are alike: of limits tried on spheres 4 to
/// 5 mm lost at no eccentricity, 4 to 8 mm at 0.9 (HeadModel.md).
constexpr EdgeLengthRange kThinLayerEdgesMm{4, 5};
constexpr std::int64_t kManyVertices = 10'000;  // MNE warns of more

bool choosesVertices(const BemModel& model) {
    return model.options.boundaries.innerSurfaces > 0 && model.options.vertices.empty() &&
           !model.options.edgeLengthMm;
}

RemeshOptions remeshOptions(const BemModel& model, const std::vector<TriangleMesh>& dense,
                            std::size_t n) {
    const BemModelOptions& options = model.options;
    RemeshOptions remesh;
    // what is left of the voxels' stairs after smoothing; ready surfaces are taken at their word
    if (model.source != BemSource::Surfaces) remesh.fitMm = kFitMm;
    remesh.edgeLengthMm = options.edgeLengthMm;
    if (choosesVertices(model)) remesh.edgeLengthMm = kThinLayerEdgesMm;
    const std::int64_t usual = model.surfaces[n].ownVertices.value_or(kDefaultVertices);
    remesh.vertices = options.verticesOf(n).value_or(options.edgeLengthMm ? 0 : usual);
    if (n > 0) remesh.neighbours.push_back(&dense[n - 1]);
    if (n + 1 < dense.size()) remesh.neighbours.push_back(&dense[n + 1]);
    return remesh;
}

/// Edges in a wrong unit ask for billions of triangles. \throws InvalidInput
void requireFewVertices(const TriangleMesh& mesh, const BemModel& model, std::size_t n) {
    const BemModelOptions& options = model.options;
    if (!options.edgeLengthMm || options.verticesOf(n)) return;
    // equilateral triangles, two a vertex, with the longest edges allowed
    const double longestMm = options.edgeLengthMm->maximumMm;
    const double least = surfaceArea(mesh) / (std::sqrt(3.0) / 2 * longestMm * longestMm);
    if (least <= kMostBemVertices) return;
    throw InvalidInput("edges of at most " + formatShort(longestMm) + " mm make more than " +
                       formatCount(kMostBemVertices) + " vertices of " +
                       bemSurfaceName(n, model.surfaces.size()) + "; they must be longer");
}

/// How many vertices each surface gets: by the lengths, or all with the same share of the most.
/// \return  the lengths, one for each vertex of each surface
std::vector<std::vector<double>> chooseVertices(const std::vector<TriangleMesh>& dense,
                                                BemModel& model) {
    std::vector<std::vector<double>> edgesMm;
    std::vector<std::int64_t> wanted;
    for (std::size_t n = 0; n < dense.size(); ++n) {
        edgesMm.push_back(wantedEdgesMm(dense[n], remeshOptions(model, dense, n)));
        wanted.push_back(verticesForEdges(dense[n], edgesMm[n]));
    }
    const std::int64_t most = model.options.mostVertices;
    const std::int64_t all = std::accumulate(wanted.begin(), wanted.end(), std::int64_t{0});
    if (all > most) {
        model.notes.push_back(
            "edges as long as the layers beside them are thick (" +
            formatShort(kThinLayerEdgesMm.minimumMm) + " to " +
            formatShort(kThinLayerEdgesMm.maximumMm) + " mm) take " + formatCount(all) +
            " vertices; all edges are " +
            formatFixed(std::sqrt(static_cast<double>(all) / static_cast<double>(most)), 2) +
            " times as long, for " + formatCount(most));
    }
    for (std::size_t n = 0; n < wanted.size(); ++n) {
        if (all > most) wanted[n] = std::max<std::int64_t>(42, wanted[n] * most / all);
        model.surfaces[n].ownVertices = wanted[n];
    }
    return edgesMm;
}

/// Ready surfaces keep their triangles unless others are asked for.
bool staysAsItCame(const BemSurface& surface, const BemModelOptions& options) {
    return surface.denseTriangles == 0 && options.vertices.empty() && !options.edgeLengthMm;
}

/// Calls work(n) for each surface, in parallel. Of those that throw the first in their order
/// counts.
void forEachSurface(const std::vector<TriangleMesh>& surfaces, const BemHooks& hooks,
                    const char* stage, const std::function<void(std::size_t)>& work) {
    const std::size_t count = surfaces.size();
    std::vector<std::int64_t> sizes;
    for (const TriangleMesh& surface : surfaces) sizes.push_back(std::ssize(surface.triangles));
    std::vector<std::exception_ptr> errors(count);
    std::atomic<std::size_t> done = 0;
    std::atomic<bool> isStopped = false;
    const std::thread::id caller = std::this_thread::get_id();
    const auto show = [&] {  // callbacks belong to the thread that gave them
        if (!hooks.progress || std::this_thread::get_id() != caller) return;
        hooks.progress(stage, static_cast<double>(done) / static_cast<double>(count));
    };
    show();
    parallelLargestFirst(sizes, [&](std::int64_t at) {
        const auto n = static_cast<std::size_t>(at);
        if (isStopped) return;
        try {
            work(n);
        } catch (...) {
            errors[n] = std::current_exception();
            return;
        }
        try {
            ++done;
            show();
        } catch (...) {  // an interruption
            errors[n] = std::current_exception();
            isStopped = true;
        }
    });
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

/// Near-equilateral triangles. What can't be had becomes a finding.
std::vector<TriangleMesh> remeshed(const std::vector<TriangleMesh>& dense, BemModel& model,
                                   const BemHooks& hooks) {
    const bool comesDense = std::all_of(
        model.surfaces.begin(), model.surfaces.end(),
        [&](const BemSurface& surface) { return !staysAsItCame(surface, model.options); });
    std::vector<std::vector<double>> edgesMm(dense.size());
    if (choosesVertices(model) && comesDense) {
        hooks.stage("remesh", [&] { edgesMm = chooseVertices(dense, model); });
    }
    std::vector<TriangleMesh> surfaces(dense.size());
    std::vector<std::optional<RemeshOptions>> options(dense.size());
    for (std::size_t n = 0; n < dense.size(); ++n) {
        if (staysAsItCame(model.surfaces[n], model.options)) {
            surfaces[n] = dense[n];
            continue;
        }
        requireFewVertices(dense[n], model, n);
        options[n] = remeshOptions(model, dense, n);
        options[n]->wantedEdgesMm = std::move(edgesMm[n]);
    }
    std::vector<Remeshed> results(dense.size());
    hooks.stage("remesh", [&] {
        forEachSurface(dense, hooks, "remesh", [&](std::size_t n) {
            if (options[n]) results[n] = remeshForBem(dense[n], *options[n]);
        });
    });
    for (std::size_t n = 0; n < dense.size(); ++n) {
        if (!options[n]) continue;
        model.surfaces[n].remesh = results[n].statistics;
        for (Finding& finding : results[n].findings) {
            finding.what = bemSurfaceName(n, model.surfaces.size()) + ": " + finding.what;
            model.findings.push_back(std::move(finding));
        }
        surfaces[n] = std::move(results[n].mesh);
    }
    return surfaces;
}

/// With the gaps asked for; empty when that can't be had.
std::vector<TriangleMesh> nested(const std::vector<TriangleMesh>& surfaces, BemModel& model,
                                 const BemHooks& hooks) {
    NestOptions nest;
    // its distance to the sources is what potentials depend on most; brain and white matter give
    // way
    nest.fixedSurface = model.options.boundaries.innerSurfaces;
    nest.minGapsMm.clear();
    for (const double gap : model.options.minGapsMm()) nest.minGapsMm.push_back(gap + kRoundingMm);
    NestResult result;
    hooks.stage("nest", [&] { result = nestSurfaces(surfaces, nest); });
    for (std::size_t n = 0; n < result.moves.size(); ++n) model.surfaces[n].move = result.moves[n];
    model.findings = result.findings;
    return std::move(result.surfaces);
}

/// "213 of 1,280 vertices were moved by up to 8.04 mm, at (1.0, 2.0, 3.0) mm RAS, ...".
std::string moveText(std::size_t n, const BemModel& model) {
    const SurfaceMove& move = model.surfaces[n].move;
    return formatCount(move.movedVertices) + " of " +
           formatCount(std::ssize(model.meshes[n].points)) + " vertices were moved by up to " +
           formatLength(move.maximumMm, 2) + " mm, at " + rasText(move.maximumPointMm) +
           ", to keep the least gap";
}

/// Warns where a remeshed surface differs from the given one.
void reportRemade(const TriangleMesh& given, std::size_t n, BemModel& model) {
    const AabbTree tree(model.meshes[n]);
    std::int64_t far = 0;
    double farthestMm = 0;
    Vec3 farthest;
    for (const Vec3& p : given.points) {
        const ClosestPoint nearest = tree.closestPoint(p);
        const double mm = std::sqrt(nearest.squaredDistanceMm2);
        if (nearest.triangle < 0 || !(mm > kMostChangeMm)) continue;
        ++far;
        if (mm <= farthestMm) continue;
        farthestMm = mm;
        farthest = p;
    }
    if (far == 0) return;
    model.warnings.push_back(
        {"surface-moved", bemSurfaceName(n, model.meshes.size()) + ": " + formatCount(far) +
                              " of " + formatCount(std::ssize(given.points)) +
                              " vertices given lie more than " + formatShort(kMostChangeMm) +
                              " mm from the model's surface, up to " + formatLength(farthestMm, 2) +
                              " mm at " + rasText(farthest)});
    model.doubts.push_back({bemSurfaceName(n, model.meshes.size()) + ": given vertex " +
                                formatLength(farthestMm, 2) + " mm from the model's surface",
                            farthest});
}

/// Surfaces that were given are changed by no more than their digits without a warning; those found
/// in an image lie where they do to a fraction of a voxel.
void reportMoves(BemModel& model) {
    constexpr double kGivenMm = 0.01, kFoundMm = 0.5;
    for (std::size_t n = 0; n < model.given.size(); ++n) reportRemade(model.given[n], n, model);
    if (!model.given.empty()) return;
    for (std::size_t n = 0; n < model.meshes.size(); ++n) {
        const double mm = model.surfaces[n].move.maximumMm;
        const std::string name = bemSurfaceName(n, model.meshes.size());
        if (model.source == BemSource::Surfaces && mm > kGivenMm) {
            model.warnings.push_back({"surface-moved", name + ": " + moveText(n, model)});
            model.doubts.push_back({name + ": moved by " + formatLength(mm, 2) + " mm",
                                    model.surfaces[n].move.maximumPointMm});
        } else if (model.source != BemSource::Surfaces && mm > kFoundMm) {
            model.notes.push_back(name + ": " + moveText(n, model));
        }
    }
}

std::string cm2Text(double mm2) {
    return formatLength(mm2 / 100, 1) + " cm2";
}

/// Warns where the model's skull and volumes differ from the segmentation.
void compareWithSegmentation(BemModel& model) {
    if (!model.segmented) return;
    const std::size_t first =
        model.meshes.size() - 3;  // of the surfaces, those within the inner skull left out
    for (std::size_t n = 0; n < 3; ++n) {
        const double mm3 = model.segmented->enclosedMm3[n];
        BemSurface& surface = model.surfaces[first + n];
        surface.segmentedMm3 = mm3;
        const double percent = 100 * (surface.volumeMm3 / mm3 - 1);
        model.notes.push_back(bemSurfaceName(first + n, model.meshes.size()) + ": encloses " +
                              formatMeasure(surface.volumeMm3 / 1000) + " cm3, " +
                              formatMeasure(mm3 / 1000) + " cm3 in the segmentation (" +
                              (percent < 0 ? "" : "+") + formatFixed(percent, 1) + " %)");
    }
    model.skull = compareSkull(model.meshes[first], model.meshes[first + 1], *model.segmented);
    const SkullComparison& skull = *model.skull;
    if (skull.holeVertices.empty()) model.segmented.reset();  // a head's worth of memory
    const auto share = [&](double mm2) {
        return cm2Text(mm2) + " (" + formatFixed(100 * mm2 / skull.areaMm2, 1) + " %)";
    };
    model.notes.push_back("skull: " + formatLength(skull.medianMm, 1) +
                          " mm thick in the segmentation (median; 5 % less than " +
                          formatLength(skull.thinMm, 1) + " mm), " +
                          formatLength(skull.modelMedianMm, 1) + " mm in the model; " +
                          share(skull.absentMm2) + " of it are not in the segmentation");
    constexpr double kMuchThicker = 0.1;  // of the area
    if (skull.thickenedMm2 > kMuchThicker * skull.areaMm2) {
        model.warnings.push_back(
            {"skull-thickened",
             share(skull.thickenedMm2) + " of the skull are thicker than in the segmentation by " +
                 formatShort(skull.thickerMm) + " mm or more, by up to " +
                 formatLength(skull.mostThickenedMm, 1) + " mm at " + rasText(*skull.thickenedMm) +
                 " (median " + formatLength(skull.medianMm, 1) + " mm, " +
                 formatLength(skull.modelMedianMm, 1) + " mm in the model)"});
        model.doubts.push_back(
            {"skull thickened by " + formatLength(skull.mostThickenedMm, 1) + " mm",
             *skull.thickenedMm});
    }
    if (!skull.holeVertices.empty()) {
        model.warnings.push_back(
            {"skull-closed", "a hole of " + share(skull.largestHoleMm2) +
                                 " in the segmentation's skull, around " + rasText(*skull.holeMm) +
                                 ", is closed in the surfaces: boundary elements need a "
                                 "closed shell; --tetrahedra leaves it open"});
        model.doubts.push_back({"hole of " + share(skull.largestHoleMm2) +
                                    " in the segmentation's skull, closed in the surfaces",
                                *skull.holeMm});
    }
}

/// Solvers take the square of the number of vertices in memory, the cube in time.
void warnOfMany(BemModel& model) {
    std::int64_t vertices = 0;
    for (const TriangleMesh& surface : model.meshes) vertices += std::ssize(surface.points);
    if (vertices <= kManyVertices) return;
    model.warnings.push_back(
        {"many-vertices", formatCount(vertices) +
                              " vertices in all; MNE and OpenMEEG store their square (MNE warns "
                              "above 10,000); ask for fewer, but for a "
                              "fast multipole solver"});
}

/// The skin as it was found, and the model's with few triangles.
HeadShape headShapeOf(TriangleMesh dense, BemModel& model) {
    constexpr std::int64_t kVertices = 1252;  // 2,500 triangles, as MNE's own sparse heads have
    HeadShape shape{std::move(dense), model.meshes.back()};
    shape.dense.normals.clear();
    if (std::ssize(shape.sparse.points) <= kVertices) return shape;
    RemeshOptions remesh;
    remesh.vertices = kVertices;
    Remeshed sparse = remeshForBem(shape.sparse, remesh);
    if (sparse.findings.empty()) {
        shape.sparse = std::move(sparse.mesh);
    } else {
        model.notes.push_back("the sparse head has the triangles of " +
                              bemSurfaceName(model.meshes.size() - 1, model.meshes.size()) + ": " +
                              sparse.findings.front().what);
    }
    return shape;
}

}  // namespace

std::vector<TriangleMesh> extractSurfaces(const HeadBoundaries& boundaries, BemModel& model,
                                          const BemHooks& hooks) {
    model.notes.insert(model.notes.end(), boundaries.notes.begin(), boundaries.notes.end());
    model.warnings.insert(model.warnings.end(), boundaries.warnings.begin(),
                          boundaries.warnings.end());
    model.doubts = boundaries.doubts;
    model.figures = boundaries.figures;
    std::vector<TriangleMesh> surfaces;
    model.seenMm = boundaries.seenMm;
    model.segmented = boundaries.segmented;
    for (const FractionField& solid : boundaries.solids) {
        hooks.stage("extract", [&] {
            const SpanSpaceIndex index = SpanSpaceIndex::build(solid.view(), {});
            ExtractionOptions extract;
            extract.isovalue = kFractionIsovalue;
            extract.method = Method::MarchingCubes;
            extract.computeNormals = false;
            surfaces.push_back(extractSurface(solid.view(), index, extract).mesh);
        });
        BemSurface surface;
        surface.denseTriangles = std::ssize(surfaces.back().triangles);
        model.surfaces.push_back(surface);
    }
    return surfaces;
}

void finishBemModel(std::vector<TriangleMesh> dense, BemModel& model, const BemHooks& hooks) {
    if (model.hasModel()) {
        std::vector<TriangleMesh> surfaces = remeshed(dense, model, hooks);
        if (model.hasModel() && surfaces.size() > 1) surfaces = nested(surfaces, model, hooks);
        if (model.hasModel()) model.meshes = std::move(surfaces);
    }
    if (model.hasModel()) checkModel(model, hooks);
    if (model.hasModel()) assessPlausibility(model, hooks);
    if (model.hasModel()) reportMoves(model);
    if (model.hasModel()) checkPial(model);
    if (model.hasModel()) addSpongyBone(model, hooks);
    if (model.hasModel()) compareWithSegmentation(model);
    for (std::size_t n = 0; model.hasModel() && n < model.seenMm.size(); ++n) {
        model.surfaces[n].seen = seenOf(model.meshes[n], model.seenMm[n]);
        model.notes.push_back(
            bemSurfaceName(n, model.meshes.size()) + ": " +
            formatRounded(100 * model.surfaces[n].seen->share) +
            " % of its area was seen in the image, the rest follows from what is near");
    }
    if (model.hasModel() && model.options.wantsHeadShape && model.meshes.size() > 1) {
        hooks.stage("remesh",
                    [&] { model.headShape = headShapeOf(std::move(dense.back()), model); });
    }
    warnOfMany(model);
    if (model.meshes.empty()) model.meshes = std::move(dense);
}

}  // namespace adaptiso
