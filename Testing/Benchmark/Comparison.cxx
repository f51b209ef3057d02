#include "Comparison.h"

#include <tbb/global_control.h>
#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "FlyingEdges.h"
#include "HeapMeter.h"
#include "VtkThreads.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso::benchmarks {
namespace {

struct Input {
    const VolumeView& volume;
    vtkSmartPointer<vtkImageData> image;  // the same samples
    const ComparisonOptions& options;
};

/// What `work` returns, and how long it took; the result is freed when the caller drops it.
template <class Work>
auto timed(const Work& work) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    auto result = work();
    const std::chrono::duration<double> elapsed = Clock::now() - begin;
    return std::pair(std::move(result), elapsed.count());
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

SpanSpaceIndex buildIndex(const Input& input, const Candidate& candidate) {
    IndexOptions options;
    options.blockSize = candidate.blockSize;
    options.border = candidate.border;
    return SpanSpaceIndex::build(input.volume, options);
}

Extraction extract(const Input& input, const Candidate& candidate, const SpanSpaceIndex& index) {
    ExtractionOptions options;
    options.isovalue = input.options.isovalue;
    options.method = candidate.method.value();
    options.computeNormals = candidate.computeNormals;
    options.discretized.mergeWithinBlocks = candidate.mergeWithinBlocks;
    options.discretized.adjustVertices = candidate.adjustVertices;
    return extractSurface(input.volume, index, options);
}

vtkSmartPointer<vtkPolyData> runFlyingEdges(const Input& input, bool computeNormals) {
    return flyingEdges(input.image, input.options.isovalue, computeNormals);
}

struct Seconds {
    double index = 0;
    double extract = 0;
};

Seconds timeOnce(const Input& input, const Candidate& candidate) {
    if (!candidate.method) {
        return {0, timed([&] { return runFlyingEdges(input, candidate.computeNormals); }).second};
    }
    const auto [index, indexSeconds] = timed([&] { return buildIndex(input, candidate); });
    const auto [extraction, extractSeconds] =
        timed([&, &built = index] { return extract(input, candidate, built); });
    return {indexSeconds, extractSeconds};
}

std::int64_t measurePeak(const Input& input, const Candidate& candidate) {
    return peakHeapBytes([&] {
        if (candidate.method) {
            const SpanSpaceIndex index = buildIndex(input, candidate);
            extract(input, candidate, index);
        } else {
            runFlyingEdges(input, candidate.computeNormals);
        }
    });
}

Costs measureCosts(const Input& input, const Candidate& candidate) {
    const Candidate flyingEdges;  // with normals
    const Candidate mc{Method::MarchingCubes, 4, candidate.border, true};
    const Candidate asc{Method::SkeletonClimbing, 4, candidate.border, true};
    for (const Candidate& each : {flyingEdges, mc, asc, candidate}) timeOnce(input, each);
    std::vector<double> index;
    std::vector<double> extraction;
    std::vector<double> extractRatio;
    std::vector<double> totalRatio;
    std::vector<double> mcRatio;
    std::vector<double> ascRatio;
    for (int repeat = 0; repeat < input.options.repeats; ++repeat) {
        const double theirs = timeOnce(input, flyingEdges).extract;
        const double mcSeconds = timeOnce(input, mc).extract;
        const double ascSeconds = timeOnce(input, asc).extract;
        const Seconds ours = timeOnce(input, candidate);
        index.push_back(ours.index);
        extraction.push_back(ours.extract);
        extractRatio.push_back(ours.extract / theirs);
        totalRatio.push_back((ours.index + ours.extract) / theirs);
        mcRatio.push_back(ours.extract / mcSeconds);
        ascRatio.push_back(ours.extract / ascSeconds);
    }
    Costs costs;
    if (candidate.method) costs.indexSeconds = median(index);
    costs.extractSeconds = median(extraction);
    costs.extractToFlyingEdges = median(extractRatio);
    costs.totalToFlyingEdges = median(totalRatio);
    costs.extractToMc = median(mcRatio);
    costs.extractToAsc = median(ascRatio);
    costs.peakHeapBytes = measurePeak(input, candidate);
    return costs;
}

/// A mesh and what its making said of it.
struct Surface {
    TriangleMesh mesh;
    std::optional<ExtractionStatistics> statistics;
    std::int64_t meshBytes = 0;
};

std::int64_t bytesOf(vtkDataArray* array) {
    return array == nullptr ? 0 : array->GetDataSize() * array->GetDataTypeSize();
}

Surface makeSurface(const Input& input, const Candidate& candidate) {
    if (!candidate.method) {
        const auto data = runFlyingEdges(input, candidate.computeNormals);
        const std::int64_t bytes = bytesOf(data->GetPoints()->GetData()) +
                                   bytesOf(data->GetPointData()->GetNormals()) +
                                   bytesOf(data->GetPolys()->GetConnectivityArray()) +
                                   bytesOf(data->GetPolys()->GetOffsetsArray());
        return {fromVtkPolyData(data), std::nullopt, bytes};
    }
    const SpanSpaceIndex index = buildIndex(input, candidate);
    Extraction result = extract(input, candidate, index);
    const TriangleMesh& mesh = result.mesh;
    const std::size_t bytes = mesh.points.size() * sizeof(Vec3) +
                              mesh.normals.size() * sizeof(Normal) +
                              mesh.triangles.size() * sizeof(Triangle);
    return {std::move(result.mesh), std::move(result.statistics), static_cast<std::int64_t>(bytes)};
}

/// In voxels along every axis, so that distances are too.
TriangleMesh inVoxels(const TriangleMesh& mesh, const ImageGeometry& geometry) {
    TriangleMesh result{mesh.points, {}, mesh.triangles};
    for (Vec3& point : result.points) point = geometry.toIndex(point);
    return result;
}

MeshFacts measureFacts(const Surface& surface, const TriangleMesh& mcInVoxels,
                       const ImageGeometry& geometry) {
    const TopologyReport topology = checkTopology(surface.mesh);
    const DistanceStatistics distance =
        surfaceDistance(inVoxels(surface.mesh, geometry), mcInVoxels).combined;
    MeshFacts facts;
    facts.triangles = topology.triangles;
    facts.ratioToMc =
        static_cast<double>(topology.triangles) / static_cast<double>(mcInVoxels.triangles.size());
    facts.meanVoxels = distance.meanMm;
    facts.maxVoxels = distance.maxMm;
    facts.boundaryEdges = topology.count(TopologyDefect::BoundaryEdge);
    facts.nonManifoldEdges = topology.count(TopologyDefect::NonManifoldEdge);
    facts.inconsistentEdges = topology.count(TopologyDefect::InconsistentEdge);
    facts.degenerateTriangles = topology.count(TopologyDefect::DegenerateTriangle);
    facts.crossingPairs = findSelfIntersections(surface.mesh).pairCount;
    facts.statistics = surface.statistics;
    facts.meshBytes = surface.meshBytes;
    return facts;
}

TriangleMesh marchingCubesInVoxels(const Input& input, Border border) {
    const Surface surface = makeSurface(input, {Method::MarchingCubes, 4, border, false});
    if (surface.mesh.triangles.empty()) {
        throw InvalidInput("compareExtractions: no surface at the isovalue " +
                           std::to_string(input.options.isovalue));
    }
    return inVoxels(surface.mesh, input.volume.geometry());
}

/// What discretized marching cubes moves a crossing by: mean over the lattice edges that
/// `mcInVoxels` has vertices on, from the vertex to the middle of its edge.
double midpointsMeanVoxels(const TriangleMesh& mcInVoxels) {
    constexpr double kHalfAHair = 5e-4;  // crossings keep 1e-3 from lattice points
    double sum = 0;
    std::int64_t count = 0;
    for (const Vec3& point : mcInVoxels.points) {
        int axes = 0;
        double along = 0;
        for (const double x : {point.x, point.y, point.z}) {
            if (std::abs(x - std::round(x)) < kHalfAHair) continue;
            ++axes;
            along = x - std::floor(x);
        }
        if (axes != 1) continue;  // the middle of a cell's loop, on no edge
        sum += std::abs(along - 0.5);
        ++count;
    }
    return sum / static_cast<double>(count);
}

std::vector<Candidate> candidatesWith(Border border, const std::vector<int>& blockSizes) {
    std::vector<Candidate> candidates;
    if (border == Border::Open) {
        for (const bool normals : {true, false}) {
            candidates.push_back({std::nullopt, 0, border, normals});
        }
    }
    for (const Method method : {Method::MarchingCubes, Method::DiscretizedMarchingCubes,
                                Method::SkeletonClimbing, Method::Boxes}) {
        for (const int blockSize : blockSizes) {
            candidates.push_back({method, blockSize, border, true});
        }
        if (method != Method::DiscretizedMarchingCubes) continue;
        for (const int blockSize : blockSizes) {
            candidates.push_back({method, blockSize, border, true, true, false});
        }
        for (const int blockSize : blockSizes) {
            candidates.push_back({method, blockSize, border, true, false, true});
        }
    }
    return candidates;
}

ComparisonRow measure(const Input& input, const Candidate& candidate,
                      const TriangleMesh& mcInVoxels) {
    ComparisonRow row{candidate, {}, measureCosts(input, candidate)};
    row.facts = measureFacts(makeSurface(input, candidate), mcInVoxels, input.volume.geometry());
    if (candidate.method) {
        const auto volumeBytes = static_cast<std::int64_t>(input.volume.byteCount());
        row.costs.boundBytes = 2 * row.facts.meshBytes + volumeBytes / 10;
    }
    return row;
}

}  // namespace

Comparison compareExtractions(const VolumeView& volume, const ComparisonOptions& options) {
    keepFreedMemory();
    const VtkThreads vtk = setVtkThreads(options.threads);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(vtk.threads));
    const Input input{volume, asVtkImage(volume), options};
    Comparison comparison{vtk.backend, vtk.threads, 0, {}};
    for (const Border border : options.borders) {
        const TriangleMesh mcInVoxels = marchingCubesInVoxels(input, border);
        if (comparison.rows.empty()) {
            comparison.midpointsMeanVoxels = midpointsMeanVoxels(mcInVoxels);
        }
        for (const Candidate& candidate : candidatesWith(border, options.blockSizes)) {
            comparison.rows.push_back(measure(input, candidate, mcInVoxels));
        }
    }
    return comparison;
}

}  // namespace adaptiso::benchmarks
