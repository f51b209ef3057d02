#pragma once

#include <cstdint>

#include "Support/Soundness.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::testing {

/// A small volume made to break things: 1 to `maximumSize` samples a side, few distinct values, so
/// that many equal the isovalue; noise, stairs along skew planes with flaws, or single voxels.
struct HardVolume {
    Volume volume;
    double isovalue;
};
HardVolume hardVolume(std::uint64_t seed, int maximumSize);

/// Builds the index and extracts.
Extraction extractFrom(const VolumeView& volume, double isovalue, Method method, int blockSize,
                       Border border);

/// Extracts by `boxes` and by `mc` and checks both: sound; the same components and the same Euler
/// characteristic, unless the boxes' own census says that boxes changed the topology; the count of
/// marching cubes' triangles that `boxes` gives is right.
::testing::AssertionResult keepsItsPromises(const HardVolume& hard, int blockSize, Border border);

}  // namespace adaptiso::testing
