#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/SimplifyAims.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/AdaptiveWork.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// How the surface is cut into triangles.
enum class Method {
    Adaptive,  ///< few triangles within a stated distance of the surface of MarchingCubes, none
               ///< crossing another
    Boxes,     ///< simple cubic boxes of many sizes, merged where they agree: the thesis's method
    DiscretizedMarchingCubes,  ///< facets between edge midpoints, merged where they are coplanar
    SkeletonClimbing,  ///< simple rectangular boxes: adaptive skeleton climbing [Poston1998]
    MarchingCubes      ///< every cell at full resolution, faces decided alike from both sides
};
std::string_view toString(Method method);

/// Aims of Method::Adaptive: distance to the surface of MarchingCubes, share of its triangles. With
/// neither bound nor count the bound is kDefaultMaxErrorVoxels. \pre maxErrorMm > 0
struct AdaptiveOptions : SimplifyAims {
    /// Fraction of the least distance between planes of samples. Chosen by measurement:
    /// Decisions/0006.
    static constexpr double kDefaultMaxErrorVoxels = 0.15;

    /// Parts that are noise stay at full resolution: within a small bound they lose half of their
    /// triangles at most, in several times the time. Not given: by the default bound alone.
    std::optional<bool> leavesNoise;

    friend bool operator==(const AdaptiveOptions&, const AdaptiveOptions&) = default;
};

/// Options of Method::DiscretizedMarchingCubes.
struct DiscretizedOptions {
    /// Put the vertices at the crossings, as the other methods do, instead of at the midpoints of
    /// their lattice edges.
    bool adjustVertices = false;
    /// Merge facets with those of the same block of the index alone. More triangles, the same
    /// surface; with blocks of 8 cells the thesis's counts.
    bool mergeWithinBlocks = false;

    friend bool operator==(const DiscretizedOptions&, const DiscretizedOptions&) = default;
};

struct ExtractionOptions {
    double isovalue = 0;  ///< inside means sample >= isovalue
    Method method = Method::Adaptive;
    AdaptiveOptions adaptive;        ///< of Method::Adaptive
    DiscretizedOptions discretized;  ///< of Method::DiscretizedMarchingCubes
    bool computeNormals = true;      ///< central differences of the volume, in physical space
    ProgressCallback progress;       ///< called as the work goes on; may be empty
};

/// --method
const Options<ExtractionOptions>& methodOptions();
/// --adjust-vertices and --merge-within-blocks
const Options<DiscretizedOptions>& discretizedOptions();

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
    /// Triangles that MarchingCubes makes of the same surface, without the two that it adds for
    /// each loop that it fills from the middle.
    std::int64_t marchingCubesTriangles = 0;
    /// Proved bound of the distance to the surface of MarchingCubes, both ways, mm
    /// (Method::Adaptive).
    std::optional<double> errorBoundMm;
    /// Count that maxTriangles and reduction ask for, if they do (Method::Adaptive). The mesh has
    /// more triangles when the bound (maxErrorMm) or the surface's topology does not allow
    /// as few.
    std::optional<std::int64_t> wantedTriangles;
    std::optional<AdaptiveWork> adaptiveWork;  ///< of Method::Adaptive
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
/// \pre  index.grid() and pixelType() fit the volume; isovalue is finite; the options of a method
///       that is not chosen are as they come; the longest side of a voxel is at most
///       10,000 times the least distance between planes of samples
///       \throws InvalidInput otherwise
/// The same input gives the same bytes, whatever the number of threads.
Extraction extractSurface(const VolumeView& volume, const SpanSpaceIndex& index,
                          const ExtractionOptions& options);

/// As above, without an index: for one isovalue of a volume, with no memory for blocks that it does
/// not touch. Who wants several isovalues builds an index once.
/// \param border  closed: the surface is closed where the inside reaches the volume's border
Extraction extractSurface(const VolumeView& volume, const ExtractionOptions& options,
                          Border border = Border::Closed);

}  // namespace adaptiso
