#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "Common/ProgramRun.h"
#include "Pipeline.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/Report/Report.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::mesher {

/// The volume as read.
struct InputSummary {
    std::string format;
    ImageGeometry geometry;
    PixelType pixelType{};
    ValueRange range{};
    std::vector<Warning> warnings;
};

/// The index over the blocks.
struct IndexSummary {
    BlockSearchKind search{};
    std::size_t memoryBytes = 0;
};

/// A surface as written.
struct SurfaceSummary : SurfaceRecord {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    CoordinateFrame frame{};
    std::uintmax_t bytes = 0;
    double diagonalMm = 0;  ///< of its box in the scan
    double scale = 1;       ///< of the file's coordinates, of which all lengths in the record are
};

/// A surface to show.
struct ShownSurface {
    TriangleMesh mesh;                    ///< LPS mm, as written
    std::vector<TrianglePair> crossings;  ///< the first
};

/// One run of the program, for the reports.
struct MeshRun : ProgramRun {
    explicit MeshRun(const MeshOptions& given)
        : ProgramRun("adaptiso-mesh", given.common, given.report, "so no surface was written"),
          options(given) {}

    const MeshOptions& options;
    InputSummary input;
    std::optional<PreprocessedImage> preprocessed;
    IndexSummary index;
    std::vector<SurfaceSummary> surfaces;
    std::vector<ShownSurface> shown{};  ///< for the page; empty unless one is wanted

    /// The range of the values that the surfaces are made from.
    const ValueRange& range() const { return preprocessed ? preprocessed->range : input.range; }
};

/// Checks what the method adaptive promises by code that it does not use: no two triangles cross,
/// no piece is inside out, components and Euler characteristic are those of the surface of marching
/// cubes, and points sampled on either surface, with the file's digits, lie within the bound of the
/// other.
/// \param mesh    extractPieces()'s \param record  what that knows of it
/// \throws InternalError  a promise is broken
Verification verify(const VolumeView& volume, const SpanSpaceIndex& index, const TriangleMesh& mesh,
                    const FileDigits& digits, const MeshOptions& options,
                    const SurfaceRecord& record);

/// Prints what adaptiso-mesh would read: geometry, values, thresholds.
/// \return kExitOk; kExitCheckFailed with --strict and warnings
/// \throws Error  as reading and preprocessing do, once the report has been delivered that says so
int runInfo(const MeshOptions& options);

/// The report that --json asks for, as README.md describes it: schema "adaptiso-mesh/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const MeshRun& run);

/// Prints the text report: the files written, what is in them, how long
/// it took.
void printReport(std::ostream& out, const MeshRun& run);

/// The report of a run whose surfaces are to be shown; they are moved out of it.
/// \param volume  must outlive the report
Report makeReport(MeshRun& run, const VolumeView& volume);

}  // namespace adaptiso::mesher
