#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "Codecs.h"

namespace adaptiso::meshio {

constexpr const char* kFrameFieldName = "CoordinateFrame";
constexpr const char* kVersionFieldName = "AdaptisoSurfaceVersion";

/// The record as VTK data with its arrays; its frame and the version of these files ("1") as
/// field data.
vtkSmartPointer<vtkPolyData> toLabelledPolyData(const MeshRecord& record);

}  // namespace adaptiso::meshio
