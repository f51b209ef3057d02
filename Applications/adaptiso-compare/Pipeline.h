#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/ReportOutput.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::compare {

/// Options of adaptiso-compare.
struct CompareOptions {
    std::filesystem::path a;
    std::filesystem::path b;                        ///< the reference
    std::vector<CoordinateFrame> inputCoordinates;  ///< of both, or of each; empty: as they say
    std::int64_t samples = 200000;                  ///< for each direction
    bool isSymmetric = true;                        ///< B to A too
    std::optional<double> voxelMm;                  ///< > 0; not together with volume
    std::filesystem::path volume;                   ///< empty: none
    ReadOptions read;                               ///< of volume
    std::filesystem::path colored;                  ///< empty: none
    std::optional<double> maxMeanMm;                ///< >= 0
    std::optional<double> maxHausdorffMm;           ///< >= 0
    ReportOptions report;
    CommonOptions common;
};

/// Reads both surfaces, brings them to one frame, measures, and writes all outputs or none.
/// \return kExitOk, or kExitCheckFailed when a distance is larger than it may be
/// \throws UsageError    --colored is no .vtp file, or an output's name is given twice
/// \throws FileError     an input can't be read, an output can't be written
/// \throws InvalidInput  a surface without area, or frames that can't be brought together
int runCompare(const CompareOptions& options);

}  // namespace adaptiso::compare
