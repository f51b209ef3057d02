#pragma once

// What programs share that read a surface and write it changed.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PrintScale.h"
#include "Common/ProgramRun.h"
#include "Common/ReportOutput.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/PointTransfer.h"
#include "adaptiso/Json/Figures.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/Report/Report.h"
#include "adaptiso/SurfacePipeline/Verification.h"

namespace adaptiso {

/// A surface as a file has it.
struct SurfaceSummary {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;  ///< empty: the file does not say
    std::int64_t triangles = 0, vertices = 0;
    TopologyReport topology;
    double areaMm2 = 0;
    double scale = 1;  ///< of an output: of its coordinates
};

/// Sets the numbers and the area.
void summarize(const TriangleMesh& mesh, SurfaceSummary& summary);

/// `input` and `output` of a report, and lines of the page's table.
const Figures<SurfaceSummary>& summaryFigures();

/// How the points of a file go to those of another.
struct FrameChange {
    CoordinateFrame frame{};              ///< of the output
    bool isSaid = true;                   ///< the output may say so
    std::optional<AffineTransform> move;  ///< empty: the points stay as they are, to the bit

    TriangleMesh apply(const TriangleMesh& mesh) const {
        return move ? transformed(mesh, *move) : mesh;
    }
    TriangleMesh undo(TriangleMesh mesh) const {
        return move ? transformed(mesh, inverse(*move)) : std::move(mesh);
    }
    /// Scales the output; its file then says no frame. Distances stay those of the input.
    void scale(double factor) {
        if (factor == 1) return;
        move = scaled(move.value_or(AffineTransform{}), factor);
        isSaid = false;
    }
    /// Upper bound on the rounding of doubles on the way there and back.
    double roundingMm(const TriangleMesh& mesh) const;
};

/// \param input   a file as read, from `file`
/// \param wanted  empty: the input's frame
/// \throws InvalidInput  the file does not say its frame, which the output has to know, or the
///                       volume that a frame belongs to
/// \throws UsageError    the output's format holds no voxel indices
FrameChange changeFrame(const MeshFile& input, const std::filesystem::path& file,
                        std::optional<CoordinateFrame> wanted, const std::filesystem::path& output);

/// Options of a program that reads a surface and writes it changed.
struct SurfaceChangeCommand {
    std::vector<std::filesystem::path> inputs;      ///< as given
    std::filesystem::path input;                    ///< the one, when it is one
    std::vector<CoordinateFrame> inputCoordinates;  ///< as for checkInputCoordinates()
    std::filesystem::path output;          ///< as for surfaceFile(); empty also: batch.outputFolder
    std::optional<CoordinateFrame> frame;  ///< empty: the input's own
    PrintScale scale;
    BatchOptions batch;
    bool isBatch = false;  ///< each input is a run of its own (Batch.h); by checkSurfaceFiles()
    ReportOptions report;
    CommonOptions common;
};

/// Checks inputs and outputs against each other, and finds what a batch needs.
/// \param purpose  for messages: "simplify"
/// \param named    other options that name files to read, which may hold "{name}"
/// \param writes   surfaces are written
/// \pre parsing is done \throws UsageError
void checkSurfaceFiles(const CLI::App& app, SurfaceChangeCommand& command,
                       const std::string& purpose,
                       std::vector<std::pair<const char*, std::filesystem::path>> named,
                       bool writes = true);

/// The name that stands for {name}: "bone" of "bone.stl", "lh" of "lh.surf.gii"; "lh.pial" of
/// itself, as FreeSurfer tells its surfaces apart by the extension.
std::string surfaceName(const std::filesystem::path& input);

/// Where the changed surface goes: `output`, or the file of the input's name in the folder that it
/// names; by default "bone-mended.stl" of "bone.stl" in the current folder.
std::filesystem::path surfaceFile(const std::filesystem::path& output,
                                  const std::filesystem::path& input, const std::string& suffix);

/// A frame that a page can show: LPS mm, or what is like it but for where it lies.
struct ShownFrame {
    AffineTransform toLps;
    std::string name;  ///< the frame in which points are reported
};

ShownFrame shownFrame(const MeshFile& input);

/// One run of a program that reads a surface and writes it changed.
struct SurfaceChangeRun : ProgramRun {
    using ProgramRun::ProgramRun;

    SurfaceSummary input{};
    SurfaceSummary output{};                     ///< no triangles: there is no result
    double roundingMm = 0;                       ///< largest move of a point by the output's digits
    std::optional<Verification> verification{};  ///< of the surface as written
    std::uintmax_t bytes = 0;                    ///< of the output
    std::vector<std::string> keptArrays{};       ///< values at points in the surface's own file

    /// Reads `input.file` as stage "read", and summarizes it.
    /// \param stated  as statedFrame() takes it \param purpose  for the message: "simplify"
    /// \param prepare  gets the mesh as read, faults and all; empty: these are refused
    /// \throws FileError, InvalidInput  it can't be read, or has no area
    MeshFile readInput(const std::vector<CoordinateFrame>& stated, const std::string& purpose,
                       const std::function<void(TriangleMesh&)>& prepare = {});

    /// Warns of a --max-error that is large for the surface's size.
    void warnOfSize(std::optional<double> maxErrorMm, const TriangleMesh& mesh);

    /// Chooses the output's scale, and sets its frame.
    void scaleOutput(const PrintScale& asked, const TriangleMesh& result, FrameChange& change);

    /// The input's values at points that the output's format holds, taken to the result.
    /// \param transfer  is made where there are any
    std::vector<PointArray> takeValues(const MeshFile& file, const TriangleMesh& result,
                                       std::optional<PointTransfer>& transfer);

    /// Moves what the output's digits would harm, measures their rounding, and writes the surface
    /// under its temporary name. \return  as it can be read
    MeshFile writeSurface(TriangleMesh result, std::vector<PointArray> values, const MeshFile& file,
                          const FrameChange& change, const std::filesystem::path& ownFolder = {});

    /// \throws InvalidInput  the output's digits alone are beyond the bound
    void requireDigits(double maxErrorMm) const;
    /// Warns where they take `reachedMm` noticeably beyond the bound.
    void warnOfRounding(double reachedMm, double maxErrorMm);

    /// Puts the result into a report, coloured by its distance from the input, and both into a
    /// table. \param before  the input, in the page's frame
    /// \param result  in the input's frame. Where it has no triangles the input is shown
    void show(TriangleMesh before, const TriangleMesh& result, const ShownFrame& frame,
              Report& report) const;

    /// Everything from the reports on. \return the exit code
    int finish(bool isWritten, const std::function<std::string()>& makeJson,
               const std::function<void(std::ostream&)>& printText);
};

/// `verification` of a report.
Json verificationJson(const std::optional<Verification>& verification);

/// The mesh without the triangles that have no area, of which nothing is promised.
TriangleMesh withArea(TriangleMesh mesh);

}  // namespace adaptiso
