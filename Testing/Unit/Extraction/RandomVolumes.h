#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>

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

/// A volume of zeros in which `isInside(x, y, z)` says where 100 stands; isovalue 50.
HardVolume binaryVolume(
    const Index3& size,
    const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& isInside);

/// Block sizes of the index, in voxels, that the methods are tested with.
inline constexpr int kBlockSizes[] = {2, 4, 8, 16};

/// A method and how it is asked for.
struct MethodChoice {
    Method method;
    bool adjustVertices = false;
    bool mergeWithinBlocks = false;

    // NOLINTNEXTLINE(google-explicit-constructor): a method alone is the plain choice
    MethodChoice(Method m, bool adjusts = false, bool mergesWithinBlocks = false)
        : method(m), adjustVertices(adjusts), mergeWithinBlocks(mergesWithinBlocks) {}
};

/// "boxes", "dmc", "dmcAdjusted", "dmcWithinBlocks": for the names of tests.
std::ostream& operator<<(std::ostream& out, const MethodChoice& choice);

/// Builds the index and extracts.
Extraction extractFrom(const VolumeView& volume, double isovalue, const MethodChoice& choice,
                       int blockSize, Border border);

/// Extracts by `choice` and by `mc` and checks both: sound; the same components and the same Euler
/// characteristic, unless the method's own census says that boxes changed the topology (unit boxes
/// never do); the count of marching cubes' triangles that the method gives is right.
::testing::AssertionResult keepsItsPromises(const HardVolume& hard, const MethodChoice& choice,
                                            int blockSize, Border border);

}  // namespace adaptiso::testing
