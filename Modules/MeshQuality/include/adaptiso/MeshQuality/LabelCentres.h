#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Walls between regions: triangle t's normal points from region labels[t][0] into labels[t][1].
struct LabelledWalls {
    const std::vector<Vec3>& points;  ///< LPS mm
    const std::vector<Triangle>& triangles;
    const std::vector<std::array<std::int32_t, 2>>& labels;
};

/// Voxels whose centre lies in another region than their label's.
struct MislabelledCentres {
    std::int64_t count = 0;
    std::optional<Index3> first;  ///< the first of them, i fastest
};

/// Looks at every voxel centre of a label map: which region the walls put it in.
///
/// Along each line of voxels (i) the triangles that it crosses are found, and on which side of them
/// each centre lies, both decided exactly (orient2d, orient3d); a line that meets an edge or a
/// corner counts as moved by an infinitesimal, and a centre on a triangle as behind it. A centre is
/// in a region that the line has entered once more than it has left it, and in no other.
///
/// Voxels of a label that is not among `regions` must be in none of them, as in 0.
/// \param map      whole numbers; the walls may be of a part of it
/// \param regions  that have their walls whole, ascending
/// \pre triangles name points that are there and finite; labels are one pair a triangle
///      \throws InvalidInput otherwise
/// Cost: O(voxels + crossings log crossings); 24 bytes a crossing.
MislabelledCentres findMislabelledCentres(const LabelledWalls& walls, const VolumeView& map,
                                          const std::vector<std::int32_t>& regions);

/// Voxels of an image by which surface their centres lie inside.
struct VoxelOverlap {
    std::int64_t voxelsA = 0;
    std::int64_t voxelsB = 0;
    std::int64_t voxelsBoth = 0;

    std::int64_t voxelsEither() const { return voxelsA + voxelsB - voxelsBoth; }
    /// 2 |A and B| / (|A| + |B|); 1 when both are empty.
    double dice() const {
        const std::int64_t sum = voxelsA + voxelsB;
        return sum > 0 ? 2 * static_cast<double>(voxelsBoth) / static_cast<double>(sum) : 1;
    }
};

/// Counts the voxels of `image` whose centres lie inside `a`, `b` and both (LPS mm): where a line
/// along i has crossed the surface an odd number of times, found as by findMislabelledCentres().
/// \pre    a and b are closed (every edge in an even number of triangles); other meshes give
///         counts without meaning. Indices in range, points finite.
/// Cost: as findMislabelledCentres(). The same counts, whatever the number of threads.
VoxelOverlap voxelOverlap(const TriangleMesh& a, const TriangleMesh& b, const ImageGeometry& image);

}  // namespace adaptiso
