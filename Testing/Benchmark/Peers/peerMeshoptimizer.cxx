// vtkFlyingEdges3D without normals, then meshopt_simplify to the count, without a limit of error.
#include <meshoptimizer.h>
#include <vtkCellArray.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "../FlyingEdges.h"
#include "../VtkThreads.h"
#include "PeerRun.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::benchmarks {
namespace {

struct Simplified {
    vtkSmartPointer<vtkPolyData> surface;  // its points serve both
    std::vector<unsigned> corners;
};

const float* pointsOf(vtkPolyData* surface) {
    if (surface->GetPoints()->GetDataType() != VTK_FLOAT) {
        throw InternalError("peerMeshoptimizer: points that are not float");
    }
    return static_cast<const float*>(surface->GetPoints()->GetVoidPointer(0));
}

std::vector<unsigned> cornersOf(vtkPolyData* surface) {
    vtkCellArray* polys = surface->GetPolys();
    std::vector<unsigned> corners;
    corners.reserve(3 * static_cast<std::size_t>(polys->GetNumberOfCells()));
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    for (polys->InitTraversal(); polys->GetNextCell(count, ids);) {
        for (vtkIdType c = 0; c < 3; ++c) corners.push_back(static_cast<unsigned>(ids[c]));
    }
    return corners;
}

Simplified simplified(vtkImageData* image, const PeerTask& task) {
    const auto surface = flyingEdges(image, task.isovalue, false);
    const std::vector<unsigned> corners = cornersOf(surface);
    // it takes no more than there are
    const std::size_t wanted =
        task.triangles ? std::min(3 * static_cast<std::size_t>(*task.triangles), corners.size())
                       : corners.size();
    constexpr float kAnyError = 1e30F;
    std::vector<unsigned> kept(corners.size());
    kept.resize(meshopt_simplify(kept.data(), corners.data(), corners.size(), pointsOf(surface),
                                 static_cast<std::size_t>(surface->GetNumberOfPoints()),
                                 3 * sizeof(float), wanted, kAnyError));
    return {surface, std::move(kept)};
}

TriangleMesh toMesh(const Simplified& simplified) {
    const float* coordinates = pointsOf(simplified.surface);
    constexpr VertexId kNone = -1;
    std::vector<VertexId> renumbered(
        static_cast<std::size_t>(simplified.surface->GetNumberOfPoints()), kNone);
    TriangleMesh mesh;
    for (std::size_t n = 0; n < simplified.corners.size(); n += 3) {
        Triangle triangle{};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t old = simplified.corners[n + c];
            if (renumbered[old] == kNone) {
                renumbered[old] = static_cast<VertexId>(mesh.points.size());
                const float* p = coordinates + 3 * old;
                mesh.points.push_back({p[0], p[1], p[2]});
            }
            triangle[c] = renumbered[old];
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

std::function<PeerSurface()> prepare(const VolumeView& volume, const PeerTask& task) {
    setVtkThreads(task.threads);
    const auto image = asVtkImage(volume);
    return [image, task] {
        auto result = std::make_shared<Simplified>(simplified(image, task));
        return PeerSurface{[result] { return toMesh(*result); }, {}, {}};
    };
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    return runPeer(argc, argv, {"peerMeshoptimizer", {"simplify"}, prepare});
}
