#pragma once

#include <itkMesh.h>
#include <itkTriangleCell.h>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// ITK's own default of coordinates is float.
template <class Coordinate = double>
using ItkMesh = itk::Mesh<Coordinate, 3,
                          itk::DefaultStaticMeshTraits<Coordinate, 3, 3, Coordinate, Coordinate>>;

/// Copies a triangle surface into an empty ITK mesh: points (LPS mm, as ITK's) and one cell per
/// triangle, in the same order and winding. Normals are left behind.
///
/// \tparam Mesh  itk::Mesh or itk::QuadEdgeMesh of three dimensions. Coordinates of type double
///               keep the points exactly; float rounds them (0.00002 mm at 200 mm).
template <class Mesh>
void fillItkMesh(const TriangleMesh& surface, Mesh& mesh) {
    mesh.GetPoints()->Reserve(surface.points.size());
    for (std::size_t id = 0; id < surface.points.size(); ++id) {
        typename Mesh::PointType point;
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = static_cast<typename Mesh::CoordRepType>(surface.points[id][axis]);
        }
        mesh.SetPoint(id, point);
    }
    for (std::size_t id = 0; id < surface.triangles.size(); ++id) {
        const auto corner = [&](int n) {
            return static_cast<itk::IdentifierType>(surface.triangles[id][n]);
        };
        if constexpr (requires { mesh.AddFaceTriangle(corner(0), corner(1), corner(2)); }) {
            mesh.AddFaceTriangle(corner(0), corner(1), corner(2));
        } else {
            using Cell = itk::TriangleCell<typename Mesh::CellType>;
            typename Mesh::CellAutoPointer cell;
            cell.TakeOwnership(new Cell);
            for (int n = 0; n < 3; ++n) cell->SetPointId(n, corner(n));
            mesh.SetCell(id, cell);
        }
    }
}

/// The same as a new itk::Mesh.
template <class Coordinate = double>
auto toItkMesh(const TriangleMesh& surface) {
    auto mesh = ItkMesh<Coordinate>::New();
    fillItkMesh(surface, *mesh);
    return mesh;
}

}  // namespace adaptiso
