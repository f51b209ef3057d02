#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::testing {

/// Closed, outward, with unit normals: 20 * 4^subdivisions triangles with corners on the sphere.
TriangleMesh icosphere(int subdivisions, const Vec3& centreMm = {}, double radiusMm = 1);
/// Closed, outward, genus 1, about the z axis: 2 * majorSteps * minorSteps triangles.
/// \pre both steps >= 3, majorRadiusMm > minorRadiusMm > 0
TriangleMesh torusMesh(int majorSteps, int minorSteps, double majorRadiusMm, double minorRadiusMm);
/// Closed, outward: 8 points, 12 triangles, without normals.
TriangleMesh cubeMesh(const Vec3& minimumMm = {0, 0, 0}, const Vec3& maximumMm = {1, 1, 1});
/// Square of the plane z = heightMm with a corner at the origin: 2 * steps^2 triangles facing +z.
TriangleMesh planeMesh(int steps, double sizeMm, double heightMm = 0);

/// All meshes in one, points not shared between them; normals if every mesh has them.
TriangleMesh merged(const std::vector<TriangleMesh>& meshes);
/// \pre mesh has no normals or is only moved
TriangleMesh translated(TriangleMesh mesh, const Vec3& byMm);

// Broken meshes: each is `mesh` (closed and sound) with the one defect that its name says.

/// Without its last triangle: three boundary edges.
TriangleMesh withHole(TriangleMesh mesh);
/// The first triangle is turned round: three edges of inconsistent orientation.
TriangleMesh withFlippedTriangle(TriangleMesh mesh);
/// The first triangle comes twice: one duplicate, and three edges with three triangles.
TriangleMesh withDuplicateTriangle(TriangleMesh mesh);
/// The first triangle is split at the midpoint of its first edge, its neighbour is not, and a
/// triangle without area closes the slit: topologically sound, one degenerate triangle.
TriangleMesh withZeroAreaTriangle(TriangleMesh mesh);
/// One more triangle that names its first vertex twice.
TriangleMesh withRepeatedIndex(TriangleMesh mesh);
/// One more point that no triangle names.
TriangleMesh withUnusedVertex(TriangleMesh mesh);
/// The first point's x is NaN.
TriangleMesh withNanCoordinate(TriangleMesh mesh);
/// One more triangle that names a point behind the last.
TriangleMesh withIndexOutOfRange(TriangleMesh mesh);

/// With a dozen faults at random places: triangles that are missing, turned round, doubled, joined
/// to any other point, or drawn through others by a corner.
TriangleMesh withRandomDamage(TriangleMesh mesh, unsigned seed);

/// Closed and oriented, every edge in two triangles, one vertex with two fans.
TriangleMesh twoSpheresTouchingAtAVertex();
/// One edge in three triangles, nothing else shared: one non-manifold edge, six boundary edges.
TriangleMesh threeTrianglesOnAnEdge();
/// Two unit spheres, their centres half a radius apart: sound, but they cross.
TriangleMesh crossingSpheres(int subdivisions);

}  // namespace adaptiso::testing
