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
#include "adaptiso/HeadPipeline/HeadNotes.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/Report/Report.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso::checker {

/// The image of --volume.
struct VolumeSummary {
    std::string format;
    ImageGeometry geometry;
};

/// One file, and what was found.
struct SurfaceRun {
    std::filesystem::path file;
    std::string error;  ///< why it can't be read; the rest is empty then
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;   ///< as the file has it; empty: it does not say
    std::optional<CoordinateFrame> points;  ///< of the points reported; empty: the file's, unknown
    SurfaceFacts facts;
    /// Distance to the isosurface; its point in that of `points`, or RAS. None: not asked for, or
    /// not to be measured.
    std::optional<DistanceStatistics> deviation;
    std::vector<Check> checks;
};

/// Two neighbours among nested surfaces.
struct NestingRun {
    std::size_t inner = 0, outer = 0;  ///< numbers of the files
    NestingReport report;
    std::vector<Check> checks;
};

/// One run of the program, for the reports.
struct CheckRun : ProgramRun {
    explicit CheckRun(const CheckOptions& given)
        : ProgramRun(kProgram, given.common, given.report, ""), options(given) {}

    const CheckOptions& options;
    std::optional<VolumeSummary> volume;
    std::vector<SurfaceRun> surfaces;
    std::vector<NestingRun> nesting;
    std::optional<CoordinateFrame> nestingFrame;  ///< of the points in nesting; empty: not known
    AffineTransform toNestingFrame;               ///< from that in which it was measured
    std::vector<ReportedNote> notes;  ///< of head models: what is unusual, asked by the profile bem

    bool hasPassed() const;  ///< all that is required holds, of all files
    bool hasFailedCheck() const;
    bool hasUnreadable() const;
};

/// The report that --json asks for, as README.md describes it: schema "adaptiso-check/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const CheckRun& run);

/// Prints the text report: which checks pass, which fail and where,
/// and whether that is what was required.
void printReport(std::ostream& out, const CheckRun& run);

/// Surfaces and image for --report and --pictures.
struct ShownSurfaces {
    struct Shown {
        std::size_t number;  ///< of the file
        TriangleMesh mesh;   ///< LPS mm; triangles and vertices numbered as in the file
    };
    std::vector<Shown> surfaces;
    /// TkRas if the scanner's frame is unknown; empty if no file states a frame
    std::optional<CoordinateFrame> frame = CoordinateFrame::Ras;
    std::vector<std::string> notes;  ///< assumptions made
    std::optional<ReadVolume> image;
};

/// The report of a run. The image, if any, stays with `shown`, which must outlive the report; the
/// meshes are moved out of it.
Report makeReport(const CheckRun& run, ShownSurfaces& shown);

}  // namespace adaptiso::checker
