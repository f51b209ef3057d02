#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::labels {

struct LabelsOptions;
struct LabelsRun;

/// Which of several masks keeps a voxel that all of them hold; of equal ones the last by name.
struct MaskPriority {
    enum class Rule { LastByName, Largest, Smallest, Listed };
    Rule rule = Rule::LastByName;
    std::filesystem::path list{};  ///< a name a line, those above win

    /// "largest", "smallest", or the name of a list
    static MaskPriority parse(const std::string& text);
    /// "name", "largest", "smallest" or "list"
    std::string word() const;
};

/// A mask that becomes a region.
struct MaskSource {
    std::filesystem::path file;
    std::string name;  ///< UTF-8 without control characters
    Label label = 0;
    std::optional<LabelColor> color{};
    ReadOptions read{};                   ///< what of the file is read
    std::optional<std::int64_t> value{};  ///< of its voxels; empty: the only one but 0
};

/// Voxels of a mask, and how many of them it kept.
struct MaskFate {
    std::string file;  ///< without folders
    Label label = 0;
    std::int64_t voxels = 0, keptVoxels = 0;
};

/// Voxels of two masks.
struct MaskOverlap {
    Label winner = 0, loser = 0;
    std::int64_t voxels = 0;
};

/// Masks as they were joined.
struct JoinedMasks {
    std::vector<MaskFate> masks;        ///< by label; empty: the input is one map
    std::int64_t sharedVoxels = 0;      ///< in two masks or more, each once
    std::vector<MaskOverlap> overlaps;  ///< most voxels first
};

/// Finds the masks that the inputs are, in options.masks: those of --join, or the images of a
/// folder that holds no DICOM and is no Zarr. None: the input is one map.
///
/// With --segments all: the segments of a DICOM segmentation, or of a .seg.nrrd with several
/// layers.
///
/// Files are numbered from 1 by name; with --names by the rows of their names, others after these.
/// \throws FileError     a link of the folder leads out of it, or nowhere
/// \throws InvalidInput  two masks have one name
void findMasks(LabelsOptions& options, LabelsRun& run);

/// Joins options.masks to a map, reading one after another, and keeps in run.joined what became of
/// each. --priority by size reads all of them twice.
/// \param format  of the first one
/// \throws FileError, InvalidInput  one can't be read, is no mask, or lies on another grid
Volume joinMasks(LabelsRun& run, std::string& format);

/// "12 voxels lie in more than one mask; the last by name keeps them: spleen 12 of liver"
std::string overlapText(const LabelsRun& run);

}  // namespace adaptiso::labels
