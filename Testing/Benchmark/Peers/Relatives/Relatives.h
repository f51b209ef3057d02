#pragma once

#include "SampleGrid.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::benchmarks {

// The relatives that the thesis surveys and no library has, in their plainest form; each says where
// it departs from its paper. Coarseness runs from 0 (finest) to 1.

/// Low-pass filter, downsampling, then marching cubes [He1995]: a Gaussian of half the new step,
/// steps of 1 to 8 voxels.
TriangleMesh downsampled(const VolumeView& volume, double isovalue, double coarseness);

/// Downsampling that keeps critical points, then marching cubes [Kraus2001]: of the samples of each
/// coarse cell the regular one, unless a local minimum, maximum or saddle (by the links in the
/// Freudenthal triangulation) lies nearer to the isovalue than all others of the other side; steps
/// of whole voxels, 1 to 8. Departure: their criterion is of all isovalues at once; that of one
/// keeps more of its topology.
TriangleMesh downsampledCritical(const SampleGrid& grid, double isovalue, double coarseness);

/// Cubes of 16 to 1 voxels, halved where the surface in them is not flat, marching cubes in each,
/// and a polygon for each crack on a face between a large cube and small ones [Shu1995]. A cube is
/// flat when each edge crosses the surface at most once and gradients in it turn from their mean by
/// at most `coarseness` x 90 degrees.
TriangleMesh adaptiveCubes(const SampleGrid& grid, double isovalue, double coarseness);

/// Tetrahedra bisected at their longest edge, from a cube around the volume down to the voxels,
/// wherever the field's error at the new vertex, or at one below it, is above a bound [Zhou1997,
/// Gerstner2000]; marching tetrahedra. The bound is `coarseness` squared x the range of the
/// samples. The error counts near the surface only. What lies outside the volume is cut off by
/// triangles.
TriangleMesh bisectedTetrahedra(const SampleGrid& grid, double isovalue, double coarseness);

/// A coarse grid (1 to 8 voxels) whose nodes are drawn to where the surface is by relaxation, then
/// marching cubes in the warped cells [Balmelli2002]. The map of variation is the share of cells
/// near a node that the surface crosses.
TriangleMesh warpedGrid(const SampleGrid& grid, double isovalue, double coarseness);

}  // namespace adaptiso::benchmarks
