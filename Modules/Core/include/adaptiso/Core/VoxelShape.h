#pragma once

#include <algorithm>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Numbers.h"

namespace adaptiso {

/// Between neighbouring planes of samples, the least of the three axes.
inline double leastPlaneDistanceMm(const ImageGeometry& geometry) {
    const Mat3 toIndex = transpose(inverse(geometry.indexToPhysical));
    return 1 /
           std::max({norm(toIndex.column[0]), norm(toIndex.column[1]), norm(toIndex.column[2])});
}

/// Refuses voxels that are needles or flakes: what may cross what is looked for over their length
/// by their width, for ever; and triangles come out lower than 1e-9 of their length, which is
/// degenerate. Scans have 300 at most (0.1 mm in planes 30 mm apart).
/// \throws InvalidInput
inline void requireNoNeedles(const ImageGeometry& geometry) {
    constexpr double kMost = 10'000;
    const Vec3 spacingMm = geometry.spacingMm();
    const double longestMm = std::max({spacingMm.x, spacingMm.y, spacingMm.z});
    const double thinMm = leastPlaneDistanceMm(geometry);
    if (longestMm <= kMost * thinMm) return;
    throw InvalidInput("a voxel is " + formatShort(longestMm) + " mm long and " +
                       formatShort(thinMm) + " mm thin, must be at most 10,000 times as long");
}

}  // namespace adaptiso
