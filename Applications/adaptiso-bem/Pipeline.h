#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/ReportOutput.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// What adaptiso-bem is asked to do.
struct BemOptions {
    // one of these five
    std::filesystem::path t1;
    std::filesystem::path labels;
    std::vector<std::filesystem::path> probabilities;
    std::filesystem::path ct;
    std::vector<std::filesystem::path> surfaces;

    std::filesystem::path brainMask;  ///< with t1
    TissueLabels tissues;             ///< with labels
    std::filesystem::path volume;     ///< with surfaces: the image whose tkRAS is written
    ReadOptions read;                 ///< of the main image
    BoundaryOptions boundaries;       ///< layers, gaps, thicknesses, isovalues

    /// One number for all surfaces or one for each; empty: 2,562, or by edge length.
    std::vector<std::int64_t> vertices;
    std::optional<EdgeLengthRange> edgeLengthMm;
    ConductivityModel conductivities;

    std::filesystem::path output;
    bool mayReplace = false;
    OpenMeegUnit unit = OpenMeegUnit::Millimetres;
    CoordinateFrame frame = CoordinateFrame::Ras;  ///< of all files but FreeSurfer's
    bool writesGifti = false;
    bool writesVtp = false;
    std::filesystem::path subjectsDir;
    std::string subject;
    bool isDryRun = false;
    ReportOptions report;
    CommonOptions common;

    /// Of skull and scalp.
    std::array<double, 2> minGapsMm() const {
        return {boundaries.minSkullMm, boundaries.minScalpMm};
    }
    std::optional<std::int64_t> verticesOf(std::size_t surface) const {
        if (vertices.empty()) return std::nullopt;
        return vertices.size() == 1 ? vertices.front() : vertices[surface];
    }
    std::size_t surfaceCount() const {
        return boundaries.innerSkullOnly ? 1 : std::size_t{kHeadSurfaceCount};
    }
};

/// Makes, checks and writes the surfaces of a head model: all of the folder or nothing of it. When
/// a guarantee can't be had the folder holds report.json alone.
/// \return  an exit code: 0, or 1 when no model could be guaranteed
/// \throws UsageError, FileError, InvalidInput  nothing was written then
int runBem(const BemOptions& options);

}  // namespace adaptiso
