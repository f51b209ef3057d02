#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "Pipeline.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadPipeline/HeadNotes.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SurfaceChecks/Checks.h"
#include "adaptiso/SurfaceChecks/SurfaceFacts.h"

namespace adaptiso {

/// What is known of --volume.
struct VolumeSummary {
    std::string format;
    ImageGeometry geometry;
};

/// One file, and what was found.
struct SurfaceRun {
    std::filesystem::path file;
    std::string error;  ///< why it can't be read; the rest is empty then
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;   ///< as the file has it; none: it does not say
    std::optional<CoordinateFrame> points;  ///< of the points reported; none: the file's, unknown
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
struct CheckRun {
    explicit CheckRun(const CheckOptions& given) : options(given) {}

    const CheckOptions& options;
    std::optional<VolumeSummary> volume;
    std::vector<SurfaceRun> surfaces;
    std::vector<NestingRun> nesting;
    std::optional<CoordinateFrame> nestingFrame;  ///< of the points in nesting; none: not known
    AffineTransform toNestingFrame;               ///< from that in which it was measured
    std::vector<ToldNote> notes;  ///< of head models: what is unusual, asked by the profile bem
    std::vector<Warning> warnings;
    StageTimer timer;
    Verdict verdict;  ///< how the run ends, known before the reports are made

    bool hasPassed() const;  ///< all that is required holds, of all files
    bool hasUnreadable() const;
};

}  // namespace adaptiso
