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
    // vectors or maps; SetPoint() and SetCell() would send an event for each
    auto& points = mesh.GetPoints()->CastToSTLContainer();
    if constexpr (requires { points.resize(1); }) points.resize(surface.points.size());
    for (std::size_t id = 0; id < surface.points.size(); ++id) {
        typename Mesh::PointType point;
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = static_cast<typename Mesh::CoordRepType>(surface.points[id][axis]);
        }
        points[id] = point;
    }
    mesh.GetPoints()->Modified();
    if constexpr (requires { mesh.AddFaceTriangle(0, 0, 0); }) {
        for (const Triangle& t : surface.triangles) {
            mesh.AddFaceTriangle(static_cast<itk::IdentifierType>(t[0]),
                                 static_cast<itk::IdentifierType>(t[1]),
                                 static_cast<itk::IdentifierType>(t[2]));
        }
    } else {
        const auto made = Mesh::CellsContainer::New();
        auto& cells = made->CastToSTLContainer();
        if constexpr (requires { cells.resize(1); }) cells.resize(surface.triangles.size());
        for (std::size_t id = 0; id < surface.triangles.size(); ++id) {
            auto* const cell =
                new itk::TriangleCell<typename Mesh::CellType>;  // the mesh deletes it
            for (int n = 0; n < 3; ++n) {
                cell->SetPointId(n, static_cast<itk::IdentifierType>(surface.triangles[id][n]));
            }
            cells[id] = cell;
        }
        mesh.SetCells(made);
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
