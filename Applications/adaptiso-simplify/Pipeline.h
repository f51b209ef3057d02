#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/PrintScale.h"
#include "Common/ReportOutput.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::simplifier {

/// Options of adaptiso-simplify.
struct SimplifyCommand {
    std::vector<std::filesystem::path> inputs;      ///< as given
    std::filesystem::path input;                    ///< the one, when it is one
    std::vector<CoordinateFrame> inputCoordinates;  ///< at most one; empty: as the input says
    std::vector<std::filesystem::path> data;        ///< files of values at its points
    SimplifyOptions aim;
    bool requiresSound = false;
    std::filesystem::path output;          ///< as for surfaceFile(); empty also: batch.outputFolder
    std::optional<CoordinateFrame> frame;  ///< empty: the input's own
    PrintScale scale;
    BatchOptions batch;
    ReportOptions report;
    CommonOptions common;

    /// Whether each input is a run of its own (Batch.h).
    bool isBatch() const {
        return batch.isRequested() || inputs.size() > 1 || holdsName(output) ||
               holdsName(report.page) || holdsName(report.pictures) ||
               std::any_of(data.begin(), data.end(), holdsName);
    }
};

/// Reads a surface and the values at its points, simplifies it, takes the values along, and writes
/// all files or none, after what was written has been read again and checked.
/// \return kExitOk; kExitCheckFailed when it has to be sound and is not, or by --strict
/// \throws UsageError     a format is unknown, can't hold the frame, or two files have one name
/// \throws FileError      an input can't be read, an output can't be written
/// \throws InvalidInput   values that are not one a point, frames that can't be brought together,
///                        coordinates that the output's format holds too coarsely
/// \throws InternalError  the result breaks a promise
int runSimplify(const SimplifyCommand& command);

}  // namespace adaptiso::simplifier
