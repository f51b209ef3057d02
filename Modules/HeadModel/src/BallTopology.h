#pragma once

#include <cstdint>
#include <vector>

#include "ImageSteps.h"

namespace adaptiso::headmodel {

/// Topology of a mask as a solid of voxels.
struct MaskTopology {
    std::int64_t eulerCharacteristic = 0;  ///< of the solid of closed cubes: 1 for a ball
    /// Squares of four and cubes of eight voxels in which only voxels that touch by an edge or a
    /// corner are inside (or outside): there a surface between the voxels would be pinched, or
    /// the choice of how to part it would change its topology [Latecki1997].
    std::int64_t criticalPlaces = 0;
};
/// \pre the mask is empty at the grid's border
MaskTopology maskTopology(const Mask& mask, const Index3& size);

/// One component (6 neighbours), no cavity, no handle, no critical place: any surface that
/// separates the voxels inside from those outside is a sphere.
bool isBall(const Mask& mask, const Index3& size);

/// The part of `allowed` that is reached from `core` by adding one voxel after the other, highest
/// priority first, such that the topology never changes (simple points [Bertrand1994]) and no
/// critical place appears. So the result is a ball when the core is one. Where `allowed` has a
/// handle, two fronts meet and one layer of voxels stays out.
/// \pre core is part of allowed; `allowed` is empty at the grid's border
Mask grownBall(const Mask& allowed, const std::vector<float>& priority, Mask core,
               const Index3& size);

/// The same from outside: `hull` with voxels outside of `kept` taken away, lowest priority first.
/// Where `kept` has a handle, a membrane of one layer of voxels stays.
/// \pre kept is part of hull; `hull` is empty at the grid's border
Mask carvedBall(const Mask& kept, const std::vector<float>& priority, Mask hull,
                const Index3& size);

/// Makes the solid of `part` (>= 0.5) a ball by changing as little as it can: stray pieces go,
/// cavities are filled; where the voxels around pinched places filled, or emptied, make it a ball,
/// no more is done; else handles are either cut (growing from the inside) or closed by a
/// membrane (carving from the outside), whichever changes fewer voxels [Kriegeskorte2001].
/// Both start as near to the solid as its erosions and dilations are balls. Changed voxels get a
/// part just beyond 0.5. \return voxels whose side changed to cut or close handles (0: it was a
/// ball but for stray
///         pieces and cavities)
/// \pre part < 0.5 at the grid's border  \throws InvalidInput  no voxel is inside
std::int64_t makeBall(std::vector<float>& part, const Index3& size);

}  // namespace adaptiso::headmodel
