// This library's methods, from samples in memory to a mesh with normals in memory; the index is
// built anew each time.
#include <tbb/global_control.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "PeerRun.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::benchmarks {
namespace {

ExtractionOptions optionsOf(const PeerTask& task, const ImageGeometry& geometry) {
    ExtractionOptions options;
    options.isovalue = task.isovalue;
    for (const Method method : {Method::Adaptive, Method::Boxes, Method::DiscretizedMarchingCubes,
                                Method::SkeletonClimbing, Method::MarchingCubes}) {
        if (toString(method) == task.method) options.method = method;
    }
    if (options.method != Method::Adaptive) return options;
    options.adaptive.maxTriangles = task.triangles;
    if (task.maxErrorVoxels) {
        const Vec3 spacing = geometry.spacingMm();
        options.adaptive.maxErrorMm =
            *task.maxErrorVoxels * std::min({spacing.x, spacing.y, spacing.z});
    }
    return options;
}

std::function<PeerSurface()> prepare(const VolumeView& volume, const PeerTask& task) {
    return [volume, task] {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(task.threads));
        const SpanSpaceIndex index =
            SpanSpaceIndex::build(volume, {.blockSize = task.blockSize, .border = task.border});
        auto result = std::make_shared<Extraction>(
            extractSurface(volume, index, optionsOf(task, volume.geometry())));
        return PeerSurface{[result] { return result->mesh; }, result->statistics.errorBoundMm,
                           result->statistics.marchingCubesTriangles};
    };
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    return runPeer(argc, argv,
                   {"peerAdaptiso", {"adaptive", "boxes", "dmc", "asc", "mc"}, prepare});
}
