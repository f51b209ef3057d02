#include "adaptiso/SurfacePipeline/FinishSurface.h"

#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

/// A surface's promise, kept or there is none: no defect; with an open border no defect but open
/// edges.
void requireSound(const TopologyReport& topology, Border border) {
    std::string faults;
    for (int n = 0; n < kTopologyDefectCount; ++n) {
        const auto defect = static_cast<TopologyDefect>(n);
        if (topology.count(defect) == 0) continue;
        if (border == Border::Open && defect == TopologyDefect::BoundaryEdge) continue;
        faults += (faults.empty() ? "" : ", ") + std::string(toString(defect)) + ": " +
                  std::to_string(topology.count(defect));
    }
    if (!faults.empty()) throw InternalError("the surface is not sound (" + faults + ")");
}

TriangleMesh keepPieces(const TriangleMesh& mesh, const ComponentSelection& selection) {
    TriangleMesh kept = selectComponents(mesh, selection);
    if (kept.triangles.empty()) throw NothingLeft("no piece of the surface has as much");
    return kept;
}

}  // namespace

std::optional<std::string> isovalueFault(double isovalue, const ValueRange& range) {
    if (!(isovalue <= range.maximum)) return "no voxel reaches it";
    if (isovalue <= range.minimum) return "every voxel reaches it, so there is no surface";
    return std::nullopt;
}

FinishedSurface finishSurface(TriangleMesh mesh, const FinishOptions& options,
                              SurfaceRecord& record) {
    const auto stage = [&](std::string_view name, const std::function<void()>& work) {
        options.runStage ? options.runStage(name, work) : work();
    };
    FinishedSurface finished{std::move(mesh), {}};
    if (!options.selection.keepsAll()) {
        stage("pieces", [&] { finished.mesh = keepPieces(finished.mesh, options.selection); });
    }
    stage("check", [&] {
        record.topology = checkTopology(finished.mesh);
        requireSound(record.topology, options.border);
        record.areaMm2 = surfaceArea(finished.mesh);
        if (record.topology.isClosed()) record.volumeMm3 = enclosedVolume(finished.mesh);
    });
    if (options.method == Method::Adaptive) {
        record.crossingPairs = 0;  // proved
    } else if (options.countsCrossings) {
        stage("crossings", [&] {
            SelfIntersections crossings =
                findSelfIntersections(finished.mesh, {.maxPairs = options.maxCrossingPairs});
            record.crossingPairs = crossings.pairCount;
            finished.crossings = std::move(crossings.pairs);
        });
    }
    return finished;
}

}  // namespace adaptiso
