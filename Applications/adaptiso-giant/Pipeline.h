#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/ReportOutput.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::giant {

/// The steps that a surface of a large volume is made in.
enum class GiantStep { Plan, Tile, Seam, Join, Run };

/// Options of adaptiso-giant.
struct GiantOptions {
    GiantStep step{};
    std::filesystem::path work;    ///< folder of the plan and of what the steps leave
    std::vector<std::string> ids;  ///< of tiles or seam boxes; empty: all

    std::filesystem::path input;
    ReadOptions read;
    std::optional<double> isovalue;
    Method method = Method::Adaptive;
    SimplifyAims aims;        ///< maxErrorMm alone
    std::int64_t side = 384;  ///< of a tile, cells

    std::filesystem::path output, preview;  ///< empty: none
    ReportOptions report;
    CoordinateFrame frame = CoordinateFrame::Ras;
    int workers = 1;
    CommonOptions common;
};

/// Does one step, or with GiantStep::Run all of them by processes of its own.
/// \return  kExitOk; kExitCheckFailed by --strict
/// \throws UsageError, InvalidInput, FileError
/// \throws InternalError  a piece, or what they make together, breaks a promise
int runGiant(const GiantOptions& options);

}  // namespace adaptiso::giant
