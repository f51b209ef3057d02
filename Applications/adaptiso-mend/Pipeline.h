#pragma once

#include <filesystem>
#include <optional>

#include "Common/SurfaceChange.h"
#include "adaptiso/Mending/Mend.h"

namespace adaptiso::mender {

/// Options of adaptiso-mend.
struct MendCommand : SurfaceChangeCommand {
    MendOptions aim;
    std::filesystem::path around;  ///< a surface that the result is to lie around; may be empty
    std::optional<double> gapMm;   ///< least distance to it
    bool isDryRun = false;         ///< no surface is written, `output` is left as it is
};

/// Reads a surface, mends it, takes the values at its points along, and writes it, after what was
/// written has been read again and checked.
/// \return kExitOk; kExitCheckFailed where it can't be mended as asked, or by --strict
/// \throws UsageError     a format is unknown or can't hold the frame
/// \throws FileError      the input can't be read, the output can't be written
/// \throws InvalidInput   nothing in the input has an area, it is in voxel indices, frames that
///                        can't be brought together, `around` is no solid, coordinates that the
///                        output's format holds too coarsely
/// \throws InternalError  the result breaks a promise
int runMend(const MendCommand& command);

}  // namespace adaptiso::mender
