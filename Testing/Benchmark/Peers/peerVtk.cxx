// vtkFlyingEdges3D without normals, alone and followed by VTK's decimators with their own defaults.
#include <vtkDecimatePro.h>
#include <vtkNew.h>
#include <vtkQuadricClustering.h>
#include <vtkQuadricDecimation.h>

#include <algorithm>

#include "../FlyingEdges.h"
#include "../VtkThreads.h"
#include "PeerRun.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

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

/// Quadrics of place and normal together [Hoppe1999], as VTK has them.
vtkSmartPointer<vtkPolyData> withAttributes(vtkPolyData* surface, const PeerTask& task) {
    const vtkNew<vtkQuadricDecimation> filter;
    filter->AttributeErrorMetricOn();
    filter->NormalsAttributeOn();
    return decimated(filter.Get(), surface, task);
}

/// Cells of 1 to 10 voxels a side, by `task.adaptivity`, each with one vertex.
vtkSmartPointer<vtkPolyData> clustered(vtkImageData* image, vtkPolyData* surface,
                                       const PeerTask& task) {
    const vtkNew<vtkQuadricClustering> filter;
    const double side =
        (1 + 9 * task.adaptivity) * *std::min_element(image->GetSpacing(), image->GetSpacing() + 3);
    double bounds[6];
    surface->GetBounds(bounds);
    const auto divisions = [&](int axis) {
        return std::max(2, static_cast<int>((bounds[2 * axis + 1] - bounds[2 * axis]) / side + .5));
    };
    filter->AutoAdjustNumberOfDivisionsOff();
    filter->SetNumberOfDivisions(divisions(0), divisions(1), divisions(2));
    filter->SetInputData(surface);
    filter->Update();
    return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> make(vtkImageData* image, const PeerTask& task) {
    const auto surface = flyingEdges(image, task.isovalue, task.method == "quadricAttributes");
    if (task.method == "quadricAttributes") return withAttributes(surface, task);
    if (task.method == "clustering") return clustered(image, surface, task);
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
    return runPeer(
        argc, argv,
        {"peerVtk", {"flyingEdges", "quadric", "quadricAttributes", "pro", "clustering"}, prepare});
}
