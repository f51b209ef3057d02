#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Mesher.h"
#include "Common/ReportOutput.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::bem {

/// Options of adaptiso-bem.
struct BemOptions {
    // one of these five
    std::filesystem::path t1;
    std::filesystem::path labels;
    std::vector<std::filesystem::path> probabilities;
    std::filesystem::path ct;
    std::vector<std::filesystem::path> surfaces;

    /// Frames of the surface, pial, white and source files, in this order. Empty: as the files say.
    std::vector<CoordinateFrame> inputCoordinates;

    std::filesystem::path brainMask;             ///< with t1
    std::filesystem::path aseg;                  ///< with t1
    std::filesystem::path lesion;                ///< with t1
    std::vector<std::filesystem::path> pial;     ///< with t1
    std::vector<std::filesystem::path> white;    ///< with t1
    std::vector<std::filesystem::path> sources;  ///< the cortex, for sources; two at most
    TissueLabels tissues;                        ///< with labels
    std::string preset;                          ///< whose; empty: none
    std::filesystem::path headMask;              ///< with labels: all that lies within the skin
    std::filesystem::path volume;  ///< with surfaces: the image whose tkRAS is written
    ReadOptions read;              ///< of the main image
    BemModelOptions model;
    BemFileOptions files;

    std::filesystem::path electrodes;                      ///< a file; empty: none
    std::optional<Vec3> nasion, leftEar, rightEar, inion;  ///< scanner RAS mm
    MesherOptions tetrahedra;
    std::filesystem::path output;
    bool mayReplace = false;
    std::filesystem::path subjectsDir;
    std::string subject;
    bool isDryRun = false;
    ReportOptions report;
    CommonOptions common;
};

/// Makes, checks and writes the surfaces of a head model: all of the folder or nothing of it. When
/// a guarantee can't be had the folder holds report.json alone.
/// \return  an exit code: 0, or 1 when no model could be guaranteed
/// \throws UsageError, FileError, InvalidInput  nothing was written then
int runBem(const BemOptions& options);

}  // namespace adaptiso::bem
