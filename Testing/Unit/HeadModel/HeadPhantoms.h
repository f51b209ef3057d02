#pragma once

#include <cstdint>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/HeadModel/FractionField.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso::testing {

/// Solids of a head from inside out: brain with CSF, skull around it, scalp around that.
struct HeadShapes {
    Shape innerSkull, outerSkull, skin;
};

/// Concentric spheres.
HeadShapes sphericalHead(const Vec3& centreMm, double innerMm, double outerMm, double skinMm);

/// 1 in the brain, 2 in the skull, 3 in the scalp, 0 outside; by the voxels' centres.
std::vector<std::uint8_t> headLabels(const HeadShapes& head, const ImageGeometry& geometry);

/// The part of every voxel inside a shape, by its depth (exact for a plane along the voxels).
std::vector<float> partInside(const Shape& shape, const ImageGeometry& geometry);

/// A T1-like image: air 0, scalp 160, skull 15, CSF 30 in a layer of csfMm, brain 100; blurred as
/// a scanner does by the parts of voxels.
std::vector<float> headT1(const HeadShapes& head, double csfMm, const ImageGeometry& geometry);

/// A CT: air -1000, scalp 40, bone 1000, brain 40.
std::vector<float> headCt(const HeadShapes& head, const ImageGeometry& geometry);

/// How far a solid's surface lies from a shape's: largest and mean |depth| of the vertices of its
/// marching-cubes surface, which must be sound and a sphere in topology.
struct SurfaceError {
    double largestMm = 0;
    double meanMm = 0;  ///< signed: negative lies inside the shape
};
SurfaceError surfaceError(const FractionField& solid, const Shape& shape);

/// Its marching-cubes surface.
TriangleMesh surfaceOf(const FractionField& solid);

}  // namespace adaptiso::testing
