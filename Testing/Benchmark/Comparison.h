#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::benchmarks {

struct ComparisonOptions {
    double isovalue = 0;
    int repeats = 5;  ///< timed runs of each, after one that is not timed
    int threads = 2;  ///< of both sides
    std::vector<int> blockSizes{2, 4, 8, 16};
    std::vector<Border> borders{Border::Open, Border::Closed};
};

/// One way to make triangles of a volume. No method: vtkFlyingEdges3D.
struct Candidate {
    std::optional<Method> method;
    int blockSize = 4;
    Border border = Border::Open;
    bool computeNormals = true;
    bool mergeWithinBlocks = false;  ///< of discretized marching cubes
    bool adjustVertices = false;     ///< of discretized marching cubes
};

/// What a surface is worth.
struct MeshFacts {
    std::int64_t triangles = 0;
    double ratioToMc = 0;   ///< triangles / those of marching cubes with the same border
    double meanVoxels = 0;  ///< distance to the surface of marching cubes, both ways
    double maxVoxels = 0;   ///< of the same
    std::int64_t boundaryEdges = 0;
    std::int64_t nonManifoldEdges = 0;
    std::int64_t inconsistentEdges = 0;
    std::int64_t degenerateTriangles = 0;
    std::int64_t crossingPairs = 0;
    std::optional<ExtractionStatistics> statistics;  ///< none for vtkFlyingEdges3D
    std::int64_t meshBytes = 0;  ///< points, normals and triangles as the method keeps them
};

/// What a surface costs. Seconds are medians.
struct Costs {
    std::optional<double> indexSeconds;  ///< none for vtkFlyingEdges3D, which has no index
    double extractSeconds = 0;
    /// Medians of the ratios to the runs of vtkFlyingEdges3D with normals, and of this library's mc
    /// and asc at N = 4, just before.
    double extractToFlyingEdges = 0;
    double totalToFlyingEdges = 0;  ///< with the index
    double extractToMc = 0;
    double extractToAsc = 0;
    std::int64_t peakHeapBytes = 0;          ///< of index and extraction, beyond the volume
    std::optional<std::int64_t> boundBytes;  ///< 2 x mesh + 10 % of the volume; ours alone
};

struct ComparisonRow {
    Candidate candidate;
    MeshFacts facts;
    Costs costs;
};

struct Comparison {
    std::string vtkBackend;  ///< of VTK's parallel loops
    int threads = 0;         ///< that both sides used: one where VTK's backend is Sequential
    /// Mean over the crossed lattice edges, of the first border, from the crossing to the middle of
    /// its edge: how far dmc's vertices are off, along their edges.
    double midpointsMeanVoxels = 0;
    std::vector<ComparisonRow> rows;
};

/// Runs vtkFlyingEdges3D, mc, asc and each of this library's methods in turn, so that what else the
/// machine does meets all, then measures the surfaces.
/// \throws InvalidInput when no surface is there at the isovalue
Comparison compareExtractions(const VolumeView& volume, const ComparisonOptions& options);

}  // namespace adaptiso::benchmarks
