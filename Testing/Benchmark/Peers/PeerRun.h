#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso::benchmarks {

/// What one run makes.
struct PeerTask {
    std::string method;  ///< one of the program's own
    double isovalue = 0;
    std::optional<std::int64_t> triangles;  ///< as many as this
    std::optional<double> maxErrorVoxels;   ///< ours: the bound, in narrowest sample distances
    double adaptivity = 0;                  ///< OpenVDB's own measure, 0 to 1
    int blockSize = 4;                      ///< ours
    Border border = Border::Closed;         ///< ours
    int threads = 2;
};

/// What one run made. The mesh is in the maker's own memory; toMesh copies it after the clock has
/// stopped.
struct PeerSurface {
    std::function<TriangleMesh()> toMesh;
    std::optional<double> boundMm;            ///< ours: the distance that is proved
    std::optional<std::int64_t> mcTriangles;  ///< ours: of marching cubes on the same surface
};

/// A program that makes surfaces.
struct PeerProgram {
    std::string name;
    std::vector<std::string> methods;
    /// Readies what is no part of the work (a handle to the samples), and gives the work.
    std::function<std::function<PeerSurface()>(const VolumeView&, const PeerTask&)> prepare;
};

/// The main of such a program:
///
///   PROGRAM VOLUME --method NAME --iso V [--triangles N] [--max-error VOXELS] [--adaptivity A]
///           [--block N] [--border open|closed] [--threads N] [--mesh FILE] [--meter-heap]
///
/// runs the method once on VOLUME (of writeVolumeFile) and prints one JSON object: triangles,
/// seconds (wall clock), cpuSeconds (all threads), peakResidentBytes (growth of the process's
/// resident set above what it held with the volume), and with --meter-heap peakHeapBytes (then the
/// seconds mean nothing). \return an exit code
int runPeer(int argc, char** argv, const PeerProgram& program);

}  // namespace adaptiso::benchmarks
