#pragma once

#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::benchmarks {

/// `volume` as VTK has it: origin, spacing and direction, the samples themselves and not a copy.
/// They must outlive it.
vtkSmartPointer<vtkImageData> asVtkImage(const VolumeView& volume);

/// The isosurface by vtkFlyingEdges3D [Schroeder2015], in LPS mm: float points, no scalars, no
/// gradients; with normals where asked for. Open at the volume's border.
vtkSmartPointer<vtkPolyData> flyingEdges(vtkImageData* image, double isovalue, bool computeNormals);

}  // namespace adaptiso::benchmarks
