// The relatives that the thesis surveys and no library has (Relatives/Relatives.h).
#include <memory>

#include "PeerRun.h"
#include "Relatives/Relatives.h"

namespace adaptiso::benchmarks {
namespace {

TriangleMesh make(const VolumeView& volume, const PeerTask& task) {
    if (task.method == "downsample") return downsampled(volume, task.isovalue, task.adaptivity);
    const SampleGrid grid(volume);
    if (task.method == "critical") {
        return downsampledCritical(grid, task.isovalue, task.adaptivity);
    }
    if (task.method == "cubes") return adaptiveCubes(grid, task.isovalue, task.adaptivity);
    if (task.method == "bisection") {
        return bisectedTetrahedra(grid, task.isovalue, task.adaptivity);
    }
    return warpedGrid(grid, task.isovalue, task.adaptivity);
}

std::function<PeerSurface()> prepare(const VolumeView& volume, const PeerTask& task) {
    return [volume, task] {
        const auto mesh = std::make_shared<TriangleMesh>(make(volume, task));
        return PeerSurface{[mesh] { return *mesh; }, {}, {}};
    };
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    return runPeer(
        argc, argv,
        {"peerRelatives", {"downsample", "critical", "cubes", "bisection", "warping"}, prepare});
}
