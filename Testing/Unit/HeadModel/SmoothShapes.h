#pragma once

#include <cstdint>
#include <functional>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::testing {

/// Positive inside; about the distance to the surface near it, mm.
using Implicit = std::function<double(const Vec3&)>;

Implicit ellipsoid(const Vec3& centreMm, const Vec3& radiiMm);
/// The union with the crease between the two filled, over about `blendMm`.
Implicit blended(Implicit a, Implicit b, double blendMm);
/// A head on its neck in a box of +-120 mm: ears (flaps 5 mm thick that stand off), nose, chin.
/// Points behind the ears are seen from no centre.
Implicit headWithEars();
/// Star-shaped: a sphere of about 60 mm with random waves.
Implicit randomStar(std::uint64_t seed);
/// Not star-shaped: a bent worm of random turns, 14 to 20 mm thick, about 150 mm long.
Implicit randomWorm(std::uint64_t seed);

/// Largest piece of marching cubes' surface of `shape` over a cube of +-halfSizeMm.
TriangleMesh denseSurface(const Implicit& shape, double halfSizeMm, double voxelMm);
/// The same of its binary volume: stairs.
TriangleMesh binarySurface(const Implicit& shape, double halfSizeMm, double voxelMm);
/// The same of any volume.
TriangleMesh denseSurface(const VolumeView& volume, double isovalue);

}  // namespace adaptiso::testing
