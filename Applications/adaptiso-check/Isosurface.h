#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {

/// The isosurface of a volume, to hold others against.
struct Isosurface {
    double isovalue = 0;
    double voxelMm = 0;  ///< the side of a cube as large as a voxel
    TriangleMesh mesh;   ///< by marching cubes, closed at the volume's border; LPS mm
};

/// \throws InvalidInput  the volume has no surface at `isovalue`
Isosurface extractIsosurface(const VolumeView& volume, double isovalue);

/// How far the surface lies from the isosurface: points spread over its area, and its vertices.
/// \param mesh  LPS mm; triangles with a corner that is not finite are left out
/// \return none when nothing with area is left
std::optional<DistanceStatistics> isosurfaceDeviation(const TriangleMesh& mesh,
                                                      const Isosurface& isosurface);

}  // namespace adaptiso
