#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/ReportOutput.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/Preprocessing/Preprocess.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso::checker {

constexpr const char* kProgram = "adaptiso-check";

/// Options of adaptiso-check.
struct CheckOptions : CheckRules {
    std::vector<std::filesystem::path> files;       ///< one or more
    std::vector<CoordinateFrame> inputCoordinates;  ///< of all, or of each; empty: as they say
    BatchOptions batch;                             ///< asked for: a run for each file
    std::filesystem::path volume;                   ///< empty: none
    ReadOptions read;                               ///< of volume
    std::optional<double> isovalue;                 ///< only together with volume
    PreprocessOptions preprocessing;                ///< of volume; only together with isovalue
    bool isSelfTest = false;                        ///< instead of all that; see SelfTest.h
    ReportOptions report;
    CommonOptions common;
};

/// Checks every file, and how they lie in each other when asked to, and prints the findings. A file
/// that can't be read does not keep the others from being checked.
/// \return kExitOk; kExitCheckFailed when something required does not hold; kExitBadInput when a
///         file could not be read
/// \throws UsageError    options that don't go together
/// \throws FileError     the volume can't be read, the report can't be written
/// \throws InvalidInput  no surface at the isovalue, or frames that can't be brought together
int runCheck(const CheckOptions& options);

}  // namespace adaptiso::checker
