#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/Mesher.h"
#include "Common/PrintScale.h"
#include "Common/ReportOutput.h"
#include "LabelLists.h"
#include "Masks.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::labels {

/// Options of adaptiso-labels.
struct LabelsOptions {
    std::vector<std::filesystem::path> inputs;  ///< as given
    std::filesystem::path input;                ///< the one, when it is one
    BatchOptions batch;
    ReadOptions read;
    bool joinsMasks = false;     ///< the inputs are masks of one map
    bool joinsSegments = false;  ///< those of a segmentation are
    PriorityOption priority;
    std::vector<MaskSource> masks;  ///< of the one map; empty: the input is a map (findMasks())
    bool takesAnyMap = false;       ///< also one that changes from voxel to voxel
    std::filesystem::path names;    ///< a table; empty: one is looked for beside the input
    LabelRanges labels;             ///< regions that are wanted; empty: all
    std::vector<LabelMerge> merges;
    SimplifyAims aims;
    MesherOptions tetrahedra;
    bool writesLayers = false;               ///< the walls for OpenMEEG
    std::map<Label, double> conductivities;  ///< of regions, S/m; empty: none are written
    /// A folder, or a file of all regions (sceneFormatOf()); empty: "<input>-labels" in the current
    /// folder.
    std::filesystem::path output;
    bool mayReplace = false;
    bool writesMap = false;
    bool namesFiles = false;               ///< of regions by their names, else by their labels
    std::string format = ".vtp";           ///< of the regions' files, an extension
    std::optional<CoordinateFrame> frame;  ///< empty: the format's own
    PrintScale scale;                      ///< of one file of all regions
    std::filesystem::path volume;          ///< shown behind the regions; empty: the input
    ReportOptions report;
    CommonOptions common;

    /// Whether each input is a run of its own (Batch.h).
    bool isBatch() const {
        return batch.isRequested() || (inputs.size() > 1 && !joinsMasks) || holdsName(output) ||
               holdsName(report.page) || holdsName(report.pictures);
    }
};

/// The format of one file for all regions, if `output` names such a file; null for a folder.
const MeshFormat* sceneFormatOf(const std::filesystem::path& output);

/// Reads the label map, extracts and checks the walls, and writes the folder, whole or not at all.
/// \return an exit code; kExitCheckFailed when the complex does not keep its promises
/// \throws UsageError    the format can't hold the frame
/// \throws FileError     an input can't be read, the output can't be written
/// \throws InvalidInput  the image is no label map, or has not the labels asked for
int runLabels(const LabelsOptions& options);

}  // namespace adaptiso::labels
