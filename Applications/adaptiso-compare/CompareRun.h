#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "Overlap.h"
#include "Pipeline.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso::compare {

/// What is known of one of the surfaces.
struct SurfaceSummary {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;  ///< none: the file does not say
    std::int64_t triangles = 0;
    std::int64_t vertices = 0;
    double areaMm2 = 0;
    std::optional<double> volumeMm3;  ///< none unless closed and oriented
    double diagonalMm = 0;            ///< of the bounding box
};

/// What is known of --volume.
struct VolumeSummary {
    std::string format;
    ImageGeometry geometry;
};

/// How the surfaces overlap, as solids.
struct OverlapSummary {
    Overlap voxels;
    double meanBoundaryOffsetMm = 0;
};

/// The coloured surface that was written.
struct ColoredSummary {
    double maximumMm = 0;  ///< where the colour map ends
    std::uintmax_t bytes = 0;
};

/// A limit that was asked for, and how it went.
struct Check {
    std::string name;  ///< "mean distance"
    std::string key;   ///< of the report: "maxMean"
    double limitMm = 0;
    double valueMm = 0;

    bool hasPassed() const { return valueMm <= limitMm; }
};

/// One run of the program, for the reports.
struct CompareRun {
    explicit CompareRun(const CompareOptions& given) : options(given) {}

    const CompareOptions& options;
    SurfaceSummary a, b;
    std::optional<VolumeSummary> volume;
    /// Frame of the reported points and of the coloured surface; empty if the files do not say it.
    std::optional<CoordinateFrame> frame;
    AffineTransform toFrame;  ///< from the frame inside the program
    std::optional<double> voxelMm;
    DistanceReport distances;
    std::optional<OverlapSummary> overlap;
    std::optional<ColoredSummary> colored;
    std::vector<Check> checks;
    std::vector<Warning> warnings;
    StageTimer timer;
    std::optional<Volume> image;  ///< for the page; none unless one is wanted
    Verdict verdict;              ///< how the run ends, known before the reports are made
};

}  // namespace adaptiso::compare
