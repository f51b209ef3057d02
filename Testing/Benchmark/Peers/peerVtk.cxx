// vtkFlyingEdges3D without normals, alone and followed by VTK's decimators with their own defaults.
#include <vtkDecimatePro.h>
#include <vtkNew.h>
#include <vtkQuadricDecimation.h>

#include <algorithm>

#include "../FlyingEdges.h"
#include "../VtkThreads.h"
#include "PeerRun.h"
#include "adaptiso/MeshIO/VtkAdaptor.h"

namespace adaptiso::benchmarks {
namespace {

/// The part of `from`'s triangles that must go to leave `task.triangles`.
double reductionOf(const PeerTask& task, vtkPolyData* from) {
    const auto all = static_cast<double>(from->GetNumberOfPolys());
    const double wanted = static_cast<double>(task.triangles.value_or(from->GetNumberOfPolys()));
    return std::clamp(1 - wanted / all, 0.0, 1.0);
}

template <class Filter>
vtkSmartPointer<vtkPolyData> decimated(Filter* filter, vtkPolyData* surface, const PeerTask& task) {
    filter->SetInputData(surface);
    filter->SetTargetReduction(reductionOf(task, surface));
    filter->Update();
    return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> make(vtkImageData* image, const PeerTask& task) {
    const auto surface = flyingEdges(image, task.isovalue, false);
    if (task.method == "quadric") {
        return decimated(vtkNew<vtkQuadricDecimation>().Get(), surface, task);
    }
    if (task.method == "pro") return decimated(vtkNew<vtkDecimatePro>().Get(), surface, task);
    return surface;
}

std::function<PeerSurface()> prepare(const VolumeView& volume, const PeerTask& task) {
    setVtkThreads(task.threads);
    const auto image = asVtkImage(volume);
    return [image, task] {
        const auto surface = make(image, task);
        return PeerSurface{[surface] { return fromVtkPolyData(surface); }, {}, {}};
    };
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    return runPeer(argc, argv, {"peerVtk", {"flyingEdges", "quadric", "pro"}, prepare});
}
