#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <random>

#include "Support/RandomPoints.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/Patch.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "lattice/LatticeSampler.h"

namespace adaptiso::testing {

/// Tolerance of distances to samples, mm: these are kept in single precision.
inline constexpr double kSampleRounding = 1e-5;

/// Voxels of 1 mm, axes along x, y, z.
detail::MetricFrame unitFrame();

/// A patch of a mesh: quadrics of its triangles, all vertices open, no sample, a box without end.
/// \param obstacles  how many of the last triangles are obstacles
detail::Patch patchOf(const TriangleMesh& mesh, std::size_t obstacles = 0);

/// A sample at every vertex of the patch, assigned to one of its triangles, normals along +z.
void addSamples(detail::Patch& patch);

/// What is not gone of a patch, without unused points.
TriangleMesh meshOf(const detail::Patch& patch);

/// The same of a surface.
TriangleMesh meshOf(const detail::SurfaceState& surface);

/// A mesh as the simplification has it, with a sample at every vertex.
detail::SimplifiedSurface surfaceOf(const TriangleMesh& mesh);

/// A volume, 1 mm voxels, by what `valueAt` says at each sample index; the surface lies at 0.
struct Scene {
    Scene(const Index3& size, const std::function<double(const Vec3&)>& valueAt,
          Border border = Border::Closed);
    Scene(Volume samples, double isovalue, Border border, int blockSize = 4);

    /// The surface of marching cubes, with its samples.
    detail::SimplifiedSurface fullSurface() const;

    Volume volume;
    SpanSpaceIndex index;
    std::unique_ptr<detail::LatticeSampler> sampler;
    detail::Bricks bricks;
    detail::MetricFrame frame;
};

/// A ball around the corner of eight bricks, or nearly; values are distances to its surface.
inline constexpr double kBallRadius = 7;
inline constexpr Vec3 kBallMiddle{28.3, 27.9, 28.1};
Scene ballScene();

/// Moves a vertex, and tells which triangles that changes.
detail::SurfaceChanges moveVertex(detail::SimplifiedSurface& surface, std::uint32_t vertex,
                                  const Vec3& place);

/// The distance from a point to the nearest of a mesh's triangles, by a look at all of them.
double distanceTo(const TriangleMesh& mesh, const Vec3& p);

}  // namespace adaptiso::testing
