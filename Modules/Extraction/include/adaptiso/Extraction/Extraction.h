#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// How the surface is cut into triangles.
enum class Method {
    Boxes,  ///< simple cubic boxes of many sizes, merged where they agree: the thesis's method
    DiscretizedMarchingCubes,  ///< facets between edge midpoints, merged where they are coplanar
    SkeletonClimbing,  ///< simple rectangular boxes: adaptive skeleton climbing [Poston1998]
    MarchingCubes      ///< every cell at full resolution, faces decided alike from both sides
};
std::string_view toString(Method method);

struct ExtractionOptions {
    double isovalue = 0;  ///< inside means sample >= isovalue
    Method method = Method::Boxes;
    /// Of discretized marching cubes: put the vertices at the crossings, as the other methods do,
    /// instead of at the midpoints of their lattice edges.
    bool adjustVertices = false;
    bool computeNormals = true;  ///< central differences of the volume, in physical space
    ProgressCallback progress;   ///< called as the work goes on; may be empty
};

/// Simple boxes of one size that the surface passes through.
struct BoxCount {
    int size = 0;             ///< cells a side; the longest side of a rectangular box
    std::int64_t shared = 0;  ///< a neighbour box divides a face
    std::int64_t unshared = 0;
};

struct ExtractionStatistics {
    std::int64_t blocksTotal = 0;
    std::int64_t blocksActive = 0;  ///< touched by the isovalue
    std::int64_t indexNodesVisited = 0;
    std::vector<BoxCount> boxes;  ///< largest size first; of dmc, unit boxes alone
    /// Boxes in which the surface of the full grid is not a set of discs, one for each loop on the
    /// box's faces: there the box's discs change its topology (a tunnel becomes two caps).
    std::int64_t boxesChangingTopology = 0;
    std::int64_t marchingCubesTriangles = 0;  ///< what MarchingCubes makes of the same surface
    std::int64_t edgesSplit = 0;  ///< edges halved because two of them joined the same two vertices
};

struct Extraction {
    TriangleMesh mesh;  ///< LPS mm, counter-clockwise seen from the low-intensity side
    ExtractionStatistics statistics;
};

/// The isosurface of `volume` at options.isovalue as a triangle mesh.
///
/// \param index  built from the same volume; its grid says the block size and what happens at the
///               volume's border.
/// \return       a closed oriented 2-manifold without degenerate triangles or unused vertices;
///               with Border::Open it is open at the volume's border and nowhere else. Empty when
///               no sample, or (open border) no edge of the grid, reaches the isovalue.
/// \pre  index.grid() and pixelType() fit the volume; isovalue is finite; adjustVertices only with
///       DiscretizedMarchingCubes    \throws InvalidInput otherwise
/// The same input gives the same bytes, whatever the number of threads.
Extraction extractSurface(const VolumeView& volume, const SpanSpaceIndex& index,
                          const ExtractionOptions& options);

}  // namespace adaptiso
