#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// The mesh as VTK polygons: double points, int64 cells, normals (if any) as the active point
/// normals "Normals" (float). A copy: the mesh may go. The frame is the mesh's own.
vtkSmartPointer<vtkPolyData> toVtkPolyData(const TriangleMesh& mesh);

/// The triangles of `data`, in the frame of `data`; its active point normals, scaled to unit
/// length, if it has any. Vertex and line cells are left out.
/// \throws InvalidInput  data is null, has a polygon that is not a triangle, a strip, a point
///                       index out of range, or normals that are not one 3-vector a point
TriangleMesh fromVtkPolyData(vtkPolyData* data);

}  // namespace adaptiso
