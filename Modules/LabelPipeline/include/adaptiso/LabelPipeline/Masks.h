#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// Which of several masks keeps a voxel that all of them hold; of equal ones the last by name.
struct MaskPriority {
    enum class Rule { LastByName, Largest, Smallest, Listed };
    Rule rule = Rule::LastByName;
    std::vector<std::size_t> listed{};  ///< places of masks, those before win; others follow

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
    std::string name;
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
    std::vector<MaskFate> masks;  ///< by label; empty: the input is one map
    MaskPriority::Rule priority{};
    std::int64_t sharedVoxels = 0;      ///< in two masks or more, each once
    std::vector<MaskOverlap> overlaps;  ///< most voxels first
};

/// A map of masks.
struct MaskMap {
    Volume volume;
    std::string format;  ///< of the first mask that was read
    JoinedMasks joined;
    std::vector<Warning> warnings;
};

/// The masks that a folder holds: its images, numbered from 1 by name.
/// \return  empty for what is no folder, a Zarr, a folder that holds DICOM or no image
/// \throws FileError     a link of the folder leads out of it, or nowhere
/// \throws InvalidInput  two masks have one name
std::vector<MaskSource> masksOfFolder(const std::filesystem::path& folder, const ReadOptions& read);

/// The masks that files are, numbered from 1 by name.
/// \throws InvalidInput  two masks have one name
std::vector<MaskSource> masksOfFiles(const std::vector<std::filesystem::path>& files,
                                     const ReadOptions& read);

/// The segments of a DICOM segmentation, or of a .seg.nrrd with several layers; empty for one with
/// a single layer, which is a map.
/// \throws FileError     a segment can't be read
/// \throws InvalidInput  the file holds no segment, or those of several segmentations
std::vector<MaskSource> masksOfSegments(const std::filesystem::path& file, const ReadOptions& read);

/// Gives masks the numbers and colours of a table's rows of their names; masks that it does not
/// name go behind its rows.
/// \param file  the table's, for warnings
/// \return "label-nameless" of those
std::vector<Warning> numberByTable(std::vector<MaskSource>& masks, const LabelTable& table,
                                   const std::string& file);

/// Reads a mask.
using ReadMask = std::function<ReadVolume(const MaskSource& mask)>;

/// Joins masks to a map, reading one after another. A priority by size reads all of them twice.
/// \param input  the folder or the file that they are from, for warnings; may be empty
/// \throws FileError, InvalidInput  one can't be read, is no mask, or lies on another grid
MaskMap joinMasks(const std::vector<MaskSource>& masks, const MaskPriority& priority,
                  const ReadMask& read, const std::string& input);

/// "12 voxels lie in more than one mask; the last by name keeps them: spleen 12 of liver"
std::string overlapText(const JoinedMasks& joined);

/// Files, voxels kept and overlaps; null of one map.
Json masksJson(const JoinedMasks& joined);

}  // namespace adaptiso
