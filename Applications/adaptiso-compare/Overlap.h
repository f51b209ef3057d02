#pragma once

#include <cstdint>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::compare {

/// Voxels of an image by which surface their centres lie inside.
struct Overlap {
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

/// Counts the voxels of `image` whose centres lie inside `a`, `b` and both (LPS mm).
///
/// Inside is where a ray along the rows of voxels has crossed the surface an odd number of times.
/// Which triangles a row passes is decided exactly, with rows moved aside by infinitely little
/// (first along k, then along j), so that a row through an edge or a corner crosses a closed
/// surface as often as any other [Edelsbrunner1990, simulation of simplicity]. Where along the row
/// is rounded: centres within some 1e-12 mm of the surface may fall to either side.
/// \pre    a and b are closed (every edge in an even number of triangles); other meshes give
///         counts without meaning. Indices in range, points finite.
/// Cost:   O(T + rows passed + voxels), slices in parallel; 8 bytes for each triangle and slice it
///         spans. The same input gives the same counts, whatever the number of threads.
///
/// [Edelsbrunner1990] H. Edelsbrunner, E. P. Muecke, Simulation of simplicity, ACM Trans. Graph.
Overlap voxelOverlap(const TriangleMesh& a, const TriangleMesh& b, const ImageGeometry& image);

}  // namespace adaptiso::compare
