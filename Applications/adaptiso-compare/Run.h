#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "Common/ProgramRun.h"
#include "Pipeline.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/MeshQuality/LabelCentres.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/Report/Report.h"
#include "adaptiso/SurfaceChecks/SurfaceSize.h"

namespace adaptiso::compare {

/// One of the two surfaces.
struct SurfaceSummary : SurfaceSize {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;  ///< empty: the file does not say
};

/// The image of --volume.
struct VolumeSummary {
    std::string format;
    ImageGeometry geometry;
};

/// How the surfaces overlap, as solids.
struct OverlapSummary {
    VoxelOverlap voxels;
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
    double leastMm = 0;  ///< the value is no less
    double valueMm = 0;  ///< and no more

    bool hasPassed() const { return valueMm <= limitMm; }
    bool hasFailed() const { return leastMm > limitMm; }
};

/// One run of the program, for the reports.
struct CompareRun : ProgramRun {
    explicit CompareRun(const CompareOptions& given)
        : ProgramRun("adaptiso-compare", given.common, given.report, ""), options(given) {}

    const CompareOptions& options;
    SurfaceSummary a, b;
    std::optional<VolumeSummary> volume;
    /// Frame of the reported points and of the coloured surface; empty if the files do not say it.
    std::optional<CoordinateFrame> frame;
    AffineTransform toFrame;  ///< from the frame inside the program
    std::optional<double> voxelMm;
    DistanceReport distances;
    HausdorffReport hausdorff;
    std::optional<OverlapSummary> overlap;
    std::optional<ColoredSummary> colored;
    std::vector<Check> checks;
    std::optional<Volume> image;  ///< for the page; empty unless one is wanted
};

/// The report that --json asks for, as README.md describes it: schema "adaptiso-compare/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const CompareRun& run);

/// Prints the text report: how far the surfaces lie apart, and where.
void printReport(std::ostream& out, const CompareRun& run);

/// Surfaces for --report and --pictures, LPS mm.
struct ShownSurfaces {
    TriangleMesh a, b;
    std::vector<double> aToBMm, bToAMm;  ///< of the vertices; the second empty with --one-sided
};

/// The report of a run, which must outlive it; the surfaces are moved out of `shown`.
Report makeReport(const CompareRun& run, ShownSurfaces& shown);

}  // namespace adaptiso::compare
