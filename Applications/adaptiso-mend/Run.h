#pragma once

#include <iosfwd>
#include <string>

#include "Common/SurfaceChange.h"
#include "Pipeline.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::mender {

/// One run of the program, for the reports.
struct MendRun : SurfaceChangeRun {
    explicit MendRun(const MendCommand& given)
        : SurfaceChangeRun("adaptiso-mend", given.common, given.report,
                           "so no surface was written"),
          command(given) {}

    const MendCommand& command;
    MendStatistics statistics{};
    bool isSearched = false;  ///< for faults: `statistics` has them
    std::string refusal{};    ///< why it can't be mended as asked
    SurfaceMove move{};       ///< to lie around another surface
    double gapMm = 0;         ///< to it, as written
    bool isCopy = false;      ///< the output has the input's bytes

    bool isMended() const { return refusal.empty(); }
    /// The result is the input.
    bool isUnchanged() const { return statistics.wasSound && move.movedVertices == 0; }
    bool writesSurface() const { return isMended() && !command.isDryRun && !failsStrict(); }
    /// How far a point of the surface as written may be from where mend() had it.
    double shiftMm() const { return move.maximumMm + roundingMm; }
    double resultToInputMm() const { return statistics.resultToInputMm + shiftMm(); }
    double inputToResultMm() const { return statistics.inputToResultMm + shiftMm(); }
};

/// A surface, and what it is checked against.
struct VerifiedSurface {
    const TriangleMesh& input;  ///< as read
    TriangleMesh surface;       ///< the result as written, in the input's frame
    double shiftMm = 0;         ///< at most, between a point of it and of the mended surface
};

/// Checks what is promised of the result, as written, by code that it was not made by: it is
/// closed, but for holes left open, 2-manifold, oriented, faces outward, crosses itself nowhere,
/// and points sampled on either surface lie within the proved bound of the other, where all of it
/// does. \param result  as computed; may be the surface itself \throws InvalidInput   the format
/// has too few digits for the result \throws InternalError  a promise is broken
void verify(const VerifiedSurface& surface, const TriangleMesh& result, MendRun& run);

/// Checks that the surface as written lies around `fixed`, in the same frame, as far as it should,
/// and sets how far. \throws InvalidInput  the format has too few digits for it
void verifyAround(const TriangleMesh& surface, const TriangleMesh& fixed, MendRun& run);

/// The report of --json, as README.md describes it, with a line break at the end.
std::string jsonReport(const MendRun& run);

/// Prints the text report.
void printReport(std::ostream& out, const MendRun& run);

/// The report that the page shows.
/// \param input  as read
/// \param shown  the result, in the input's frame; no triangles: it can't be mended as asked
Report makeReport(const MendRun& run, const MeshFile& input, const TriangleMesh& shown);

}  // namespace adaptiso::mender
