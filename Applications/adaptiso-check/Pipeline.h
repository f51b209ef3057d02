#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/ReportOutput.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {

/// What a surface is for, which says what is required of it.
enum class Profile {
    Bem,    ///< a boundary of a head model
    Print,  ///< a solid to print or to compute with
    View    ///< to look at
};

/// What adaptiso-check is asked to do.
struct CheckOptions {
    std::vector<std::filesystem::path> files;  ///< one or more
    BatchOptions batch;                        ///< asked for: a run for each file
    bool isNested = false;                     ///< they lie in each other, the innermost first
    std::optional<Profile> profile;            ///< none: Bem when nested, else Print
    std::filesystem::path volume;              ///< empty: none
    ReadOptions read;                          ///< of volume
    std::optional<double> isovalue;            ///< only together with volume
    PreprocessOptions preprocessing;           ///< of volume; only together with isovalue
    std::optional<double> minGapMm;            ///< none: kDefaultMinGapMm, required of Bem only
    std::optional<double> minAngleDeg;         ///< none: kDefaultMinAngleDeg, required of Bem only
    std::optional<double> maxOffMm;            ///< none: half a voxel on the mean
    std::int64_t maxPairs = 1000;              ///< of triangles that cross, to list
    bool isSelfTest = false;                   ///< instead of all that; see SelfTest.h
    ReportOptions report;
    CommonOptions common;

    static constexpr double kDefaultMinGapMm = 0.5;   // thinner than any bone of the skull
    static constexpr double kDefaultMinAngleDeg = 1;  // slivers that only bad remeshing leaves

    Profile profileInUse() const {
        return profile.value_or(isNested ? Profile::Bem : Profile::Print);
    }
};

/// Checks every file, and how they lie in each other when asked to, and prints the findings. A file
/// that can't be read does not keep the others from being checked.
/// \return kExitOk; kExitCheckFailed when something required does not hold; kExitBadInput when a
///         file could not be read
/// \throws UsageError    options that don't go together
/// \throws FileError     the volume can't be read, the report can't be written
/// \throws InvalidInput  no surface at the isovalue, or frames that can't be brought together
int runCheck(const CheckOptions& options);

}  // namespace adaptiso
