// vtkQuadricClustering, apart from the rest since VTK's headers are slow to compile.
#include <vtkPointData.h>
#include <vtkQuadricClustering.h>

#include <algorithm>
#include <cmath>

#include "Payload.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/MeshIO/VtkAdaptor.h"

namespace adaptiso {
namespace {

TriangleMesh clustered(vtkPolyData* data, int divisions) {
    const auto filter = vtkSmartPointer<vtkQuadricClustering>::New();
    filter->SetInputData(data);
    filter->AutoAdjustNumberOfDivisionsOff();
    filter->SetNumberOfDivisions(divisions, divisions, divisions);
    filter->CopyCellDataOff();
    filter->Update();
    return fromVtkPolyData(filter->GetOutput());
}

/// Each new vertex takes the value of the nearest corner of the nearest old triangle.
std::vector<double> valuesAt(const std::vector<Vec3>& points, const SceneSurface& surface) {
    const AabbTree tree(surface.mesh);
    std::vector<double> values;
    for (const Vec3& p : points) {
        const Triangle& t = surface.mesh.triangles[tree.closestPoint(p).triangle];
        const VertexId nearest = *std::min_element(t.begin(), t.end(), [&](auto a, auto b) {
            return squaredNorm(surface.mesh.points[a] - p) <
                   squaredNorm(surface.mesh.points[b] - p);
        });
        values.push_back(surface.valuesMm[nearest]);
    }
    return values;
}

}  // namespace

SceneSurface coarser(const SceneSurface& surface, std::int64_t maxTriangles) {
    if (std::ssize(surface.mesh.triangles) <= maxTriangles) return surface;
    SceneSurface result = surface;
    const vtkSmartPointer<vtkPolyData> data = toVtkPolyData(surface.mesh);
    // a closed surface in a cube of n^3 cells meets about 6 n^2 of them, two triangles in each
    int divisions = std::max(8, static_cast<int>(std::sqrt(static_cast<double>(maxTriangles) / 4)));
    do {
        result.mesh = clustered(data, divisions);
        divisions = divisions * 4 / 5;
    } while (std::ssize(result.mesh.triangles) > maxTriangles && divisions >= 2);
    if (!surface.valuesMm.empty()) result.valuesMm = valuesAt(result.mesh.points, surface);
    return result;
}

}  // namespace adaptiso
