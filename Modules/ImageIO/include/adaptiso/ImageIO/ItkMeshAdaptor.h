#pragma once

#include <itkMesh.h>
#include <itkTriangleCell.h>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Copies a triangle surface into an ITK mesh: points (LPS mm, as ITK's) and one itk::TriangleCell
/// per triangle, in the same order and winding. Normals are left behind.
///
/// \tparam Coordinate  double keeps the points exactly; float rounds them (0.00002 mm at 200 mm).
template <class Coordinate = double>
auto toItkMesh(const TriangleMesh& surface) {
    using Traits = itk::DefaultStaticMeshTraits<Coordinate, 3, 3, Coordinate, Coordinate>;
    using Mesh = itk::Mesh<Coordinate, 3, Traits>;
    using Cell = itk::TriangleCell<typename Mesh::CellType>;

    auto mesh = Mesh::New();
    mesh->GetPoints()->Reserve(surface.points.size());
    for (std::size_t id = 0; id < surface.points.size(); ++id) {
        typename Mesh::PointType point;
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = static_cast<Coordinate>(surface.points[id][axis]);
        }
        mesh->SetPoint(id, point);
    }
    for (std::size_t id = 0; id < surface.triangles.size(); ++id) {
        typename Mesh::CellAutoPointer cell;
        cell.TakeOwnership(new Cell);
        for (int corner = 0; corner < 3; ++corner) {
            cell->SetPointId(corner,
                             static_cast<itk::IdentifierType>(surface.triangles[id][corner]));
        }
        mesh->SetCell(id, cell);
    }
    return mesh;
}

}  // namespace adaptiso
