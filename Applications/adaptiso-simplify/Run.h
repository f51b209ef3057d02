#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "Common/SurfaceChange.h"
#include "Pipeline.h"
#include "adaptiso/Extraction/PointTransfer.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshIO/PointData.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::simplifier {

/// A kind of places where a surface is not sound.
struct Finding {
    std::string_view key;         ///< of the report: "borderEdges"
    std::string what;             ///< for people: "open border edge"
    std::int64_t count = 0;       ///< > 0, or not complete
    bool isComplete = true;       ///< false: there may be more, findCrossingPairs() says when
    std::optional<Vec3> placeMm;  ///< of the first of them, as the file has it
    bool isDropped = false;       ///< else kept as it is
    bool isFault = true;          ///< the surface is not sound for it

    /// "3 triangles without area, dropped; the first at 1, 2, 3"
    std::string text() const;
};

bool isSound(const std::vector<Finding>& findings);

/// The faults of a surface's topology.
std::vector<Finding> findTopologyFaults(const TriangleMesh& mesh, const TopologyReport& topology);

/// Puts the vertices that --weld joined in place of those that no triangle uses for it.
void addJoined(std::int64_t joined, std::vector<Finding>& findings);

/// Triangles that cross others, or may.
std::optional<Finding> crossingFinding(const TriangleMesh& mesh,
                                       const CrossingTriangles& triangles);

/// Values that were taken along in a file of their own.
struct DataSummary {
    std::filesystem::path file, output;
    PointDataFormat format{};
    std::int64_t arrays = 0;
    bool areLabels = false;  ///< all of them
};

/// One run of the program, for the reports.
struct SimplifyRun : SurfaceChangeRun {
    explicit SimplifyRun(const SimplifyCommand& given)
        : SurfaceChangeRun("adaptiso-simplify", given.common, given.report,
                           "so no surface was written"),
          command(given) {}

    const SimplifyCommand& command;
    std::vector<Finding> findings{};  ///< faults of the input; empty: it is sound
    SimplifyStatistics statistics{};
    std::vector<DataSummary> data{};

    /// --require-sound, and it is not.
    bool failsSoundness() const { return command.requiresSound && !isSound(findings); }
    /// Bound on the distance between input and output as written, both ways.
    double errorBoundMm() const { return statistics.errorBoundMm + roundingMm; }
    bool writesSurface() const { return !failsSoundness() && !failsStrict(); }
    /// The count of --triangles or --reduction was met; empty if no count was given.
    std::optional<bool> countMet() const {
        if (!statistics.wantedTriangles) return std::nullopt;
        return output.triangles <= *statistics.wantedTriangles;
    }
};

/// Where values go: beside the surface, under their own name; where that is the file they are from,
/// with "simplified" in its name ("lh.simplified.thickness", "a.simplified.shape.gii").
std::filesystem::path dataFile(const std::filesystem::path& data,
                               const std::filesystem::path& surface);

/// As transferred() of an array in the surface's own file.
PointData transferred(PointData data, const PointTransfer& transfer);

/// A surface as written, and what it is checked against.
struct VerifiedSurface {
    const TriangleMesh& input;   ///< as read
    const TriangleMesh& result;  ///< as computed, in the input's frame
    TriangleMesh written;        ///< as read again, in the input's frame
    double roundingMm = 0;       ///< at most, between a point of `result` and of `written`
};

/// Checks what is promised of the result, as written, by code that it was not made by: a sound
/// surface has stayed sound, with its pieces and handles, no more triangles cross than before, and
/// points sampled on either surface lie within the proved bound of the other.
/// \param run  with the input's topology and findings, and the statistics; gets the output's
///             topology and the verification
/// \throws InvalidInput   the format has too few digits for the result
/// \throws InternalError  a promise is broken
void verify(const VerifiedSurface& surface, SimplifyRun& run);

/// The report of --json, as README.md describes it, with a line break at the end.
std::string jsonReport(const SimplifyRun& run);

/// Prints the text report.
void printReport(std::ostream& out, const SimplifyRun& run);

/// The report that the page shows.
/// \param input  as read
/// \param shown  the result, in the input's frame; empty: the surface was refused
Report makeReport(const SimplifyRun& run, const MeshFile& input, const TriangleMesh& shown);

}  // namespace adaptiso::simplifier
