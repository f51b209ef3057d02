#include "adaptiso/SurfacePipeline/FinishSurface.h"

#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso {
namespace {

/// Returns the defects of a surface, open edges at an open border aside; empty if sound.
std::string faultsOf(const TopologyReport& topology, Border border) {
    std::string faults;
    for (int n = 0; n < kTopologyDefectCount; ++n) {
        const auto defect = static_cast<TopologyDefect>(n);
        if (topology.count(defect) == 0) continue;
        if (border == Border::Open && defect == TopologyDefect::BoundaryEdge) continue;
        addPart(faults,
                std::string(toString(defect)) + ": " + std::to_string(topology.count(defect)));
    }
    return faults;
}

TriangleMesh keepPieces(const TriangleMesh& mesh, const ComponentSelection& selection) {
    TriangleMesh kept = selectComponents(mesh, selection);
    if (kept.triangles.empty()) throw NothingLeft("no piece of the surface has as much");
    return kept;
}

/// Facts of a mesh that do not depend on how it was made. \return  as faultsOf()
std::string measure(const TriangleMesh& mesh, const FinishOptions& options, SurfaceRecord& record) {
    record.topology = checkTopology(mesh);
    std::string faults = faultsOf(record.topology, options.border);
    if (!faults.empty()) return faults;
    record.sizeMm = boundingBox(mesh).size();
    record.areaMm2 = surfaceArea(mesh);
    if (!record.topology.isClosed()) return faults;
    record.volumeMm3 = enclosedVolume(mesh);
    if (options.border == Border::Open) return faults;  // a cavity's outer wall may be missing
    if (const auto pieces = findInsideOutPieces(mesh, record.topology)) {
        record.insideOutPieces = std::ssize(*pieces);
    }
    if (options.method == Method::Adaptive && record.insideOutPieces.value_or(0) > 0) {
        faults = "pieces inside out: " + std::to_string(*record.insideOutPieces);
    }
    return faults;
}

/// Moves what rounding would harm, and measures the rounding.
/// \return  the mesh as the file holds it; none where that is the mesh itself
std::optional<TriangleMesh> fitToDigits(TriangleMesh& mesh, const FinishOptions& options,
                                        SurfaceRecord& record) {
    if (!options.digits) return std::nullopt;
    const auto& [format, toFrame, requestedBoundMm] = *options.digits;
    if (format->precision == CoordinatePrecision::Float64) {
        record.roundingMm = 0;
        return std::nullopt;
    }
    if (!options.countsCrossings && options.method != Method::Adaptive) {
        return asStored(mesh, format->precision, toFrame);
    }
    const RoundingHarm harm = settleRounding(mesh, format->precision, toFrame);
    if (harm) throw TooFewDigits(textOf(harm, *format));
    record.roundingMm = harm.roundingMm;
    if (requestedBoundMm) {
        const auto fault = roundingFault(harm.roundingMm, *requestedBoundMm, *format);
        if (fault) throw TooFewDigits(*fault);
    }
    return asStored(mesh, format->precision, toFrame);
}

void requireSound(const TriangleMesh& mesh, const std::optional<TriangleMesh>& stored,
                  const FinishOptions& options, SurfaceRecord& record) {
    const std::string faults = measure(stored ? *stored : mesh, options, record);
    if (faults.empty()) return;
    if (stored) {
        SurfaceRecord exact;
        if (measure(mesh, options, exact).empty()) {
            throw TooFewDigits(std::string(options.digits->format->name) +
                               " keeps too few digits of this surface's coordinates, with which "
                               "it is not sound (" +
                               faults + "); write a .vtp or .ply");
        }
    }
    throw InternalError("the surface is not sound (" + faults + ")");
}

}  // namespace

std::optional<std::string> isovalueFault(double isovalue, const ValueRange& range) {
    if (!(isovalue <= range.maximum)) return "no voxel reaches it";
    if (isovalue <= range.minimum) return "every voxel reaches it, so there is no surface";
    return std::nullopt;
}

TriangleMesh extractPieces(const Extractor& extract, const ExtractionOptions& options,
                           const ComponentSelection& selection, SurfaceRecord& record) {
    const AdaptiveOptions& aims = options.adaptive;
    record.choseFirst = !selection.keepsAll() && (aims.maxTriangles || aims.reduction);
    const auto whole = [&] {
        Extraction extraction = extract(options);
        record.statistics = std::move(extraction.statistics);
        record.madeTriangles = std::ssize(extraction.mesh.triangles);
        return std::move(extraction.mesh);
    };
    if (!record.choseFirst) return whole();
    ExtractionOptions atFullResolution = options;
    atFullResolution.method = Method::MarchingCubes;
    atFullResolution.adaptive = {};
    Extraction full = extract(atFullResolution);
    if (full.mesh.triangles.empty()) return {};
    TriangleMesh kept = keepPieces(full.mesh, selection);
    record.isPart = kept.triangles.size() < full.mesh.triangles.size();
    full.mesh = {};
    if (!record.isPart) return whole();
    Simplified made =
        simplify(kept, {aims, /*keepBorders=*/false, /*weld=*/false, options.progress});
    record.statistics = std::move(full.statistics);
    record.statistics.marchingCubesTriangles = std::ssize(kept.triangles);
    record.statistics.errorBoundMm = made.statistics.errorBoundMm;
    record.statistics.wantedTriangles = made.statistics.wantedTriangles;
    record.statistics.adaptiveWork = made.statistics.work;
    record.madeTriangles = std::ssize(made.mesh.triangles);
    return std::move(made.mesh);
}

std::optional<double> requestedBoundMm(const ExtractionOptions& options,
                                       const ImageGeometry& volume) {
    const AdaptiveOptions& aims = options.adaptive;
    if (options.method != Method::Adaptive) return std::nullopt;
    if (aims.maxErrorMm || aims.maxTriangles || aims.reduction) return aims.maxErrorMm;
    return AdaptiveOptions::kDefaultMaxErrorVoxels * leastPlaneDistanceMm(volume);
}

FinishedSurface finishSurface(TriangleMesh mesh, const FinishOptions& options,
                              SurfaceRecord& record) {
    const auto stage = [&](std::string_view name, const std::function<void()>& work) {
        options.runStage ? options.runStage(name, work) : work();
    };
    FinishedSurface finished{std::move(mesh), {}};
    if (!options.selection.keepsAll() && !record.choseFirst) {
        stage("pieces", [&] {
            const std::size_t before = finished.mesh.triangles.size();
            finished.mesh = keepPieces(finished.mesh, options.selection);
            record.isPart = finished.mesh.triangles.size() < before;
        });
    }
    std::optional<TriangleMesh> stored;
    stage("check", [&] {
        stored = fitToDigits(finished.mesh, options, record);
        requireSound(finished.mesh, stored, options, record);
    });
    if (options.method == Method::Adaptive) {
        record.crossingPairs = 0;  // proved, and kept by fitToDigits()
    } else if (options.countsCrossings) {
        stage("crossings", [&] {
            SelfIntersections crossings = findSelfIntersections(
                stored ? *stored : finished.mesh, {.maxPairs = options.maxCrossingPairs});
            if (crossings.isComplete) record.crossingPairs = crossings.pairCount;
            finished.crossings = std::move(crossings.pairs);
        });
    }
    return finished;
}

}  // namespace adaptiso
