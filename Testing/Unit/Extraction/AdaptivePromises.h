#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::testing {

/// A volume and what is asked of Method::Adaptive.
struct AdaptiveCase {
    Volume volume;
    double isovalue = 0;
    int blockSize = 4;
    Border border = Border::Closed;
    AdaptiveOptions options;
};

/// A case made to break promises, 3 to `maximumSize` samples a side: bytes of few values (noise,
/// stairs with flaws, single voxels), floats that equal the isovalue, lie a rounding beside it, are
/// NaN or immense, and smooth waves; in voxels of 1 mm, slabs, sheared and mirrored grids, microns
/// and metres, far from the origin; closed and open; with a bound, a count, a reduction, a least
/// angle, or several.
AdaptiveCase adaptiveCase(std::uint64_t seed, int maximumSize);

/// "seed 7: 5 x 3 x 8 float32, isovalue 0, N = 4, closed, maxErrorMm 0.1": enough to repeat it.
std::string describe(std::uint64_t seed, const AdaptiveCase& adaptive);

/// What a referee says of a mesh of ours: whether triangles of it cross.
using CrossingReferee = std::function<bool(const TriangleMesh&)>;

/// Extracts by the adaptive method and by `mc` and checks every promise, with no code of the
/// method's: sound, its pieces nested as those of `mc` (isSound); no triangles cross (MeshQuality,
/// and `referee` if given); components and Euler characteristic of `mc`; the bound that is reported
/// is not above the bound asked for; and dense samples of each surface (a lattice on every
/// triangle, corners and middles of edges among it, an eighth of a voxel apart) lie within the
/// reported bound of the other.
::testing::AssertionResult keepsAdaptivePromises(const AdaptiveCase& adaptive,
                                                 const CrossingReferee& referee = {});

}  // namespace adaptiso::testing
