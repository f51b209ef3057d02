#pragma once

#include <filesystem>
#include <vector>

#include "Common/SurfaceChange.h"
#include "adaptiso/Extraction/Simplify.h"

namespace adaptiso::simplifier {

/// Options of adaptiso-simplify.
struct SimplifyCommand : SurfaceChangeCommand {
    std::vector<std::filesystem::path> data;  ///< files of values at its points
    SimplifyOptions aim;
    bool requiresSound = false;
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
