#pragma once

#include <optional>
#include <string>
#include <vector>

#include "CheckRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What --report and --pictures show, besides what the run tells.
struct ShownSurfaces {
    struct Shown {
        std::size_t number;  ///< of the file
        TriangleMesh mesh;   ///< LPS mm; triangles and vertices numbered as in the file
    };
    std::vector<Shown> surfaces;
    /// TkRas where the scanner's is not known; none where no file says a frame
    std::optional<CoordinateFrame> frame = CoordinateFrame::Ras;
    std::vector<std::string> notes;  ///< what had to be assumed
    std::optional<ReadVolume> image;
};

/// The report of a run. The image, if any, stays with `shown`, which must outlive the report; the
/// meshes are moved out of it.
Report makeReport(const CheckRun& run, ShownSurfaces& shown);

}  // namespace adaptiso
