#pragma once

#include <filesystem>
#include <string>

#include "adaptiso/LabelPipeline/Masks.h"

namespace adaptiso::labels {

struct LabelsOptions;
struct LabelsRun;

/// --priority: a rule by size, or a list of names, a name a line, those above win.
struct PriorityOption {
    MaskPriority priority{};
    std::filesystem::path list{};  ///< empty: a rule by size, or none

    /// "largest", "smallest", or the name of a list
    static PriorityOption parse(const std::string& text);
    bool isGiven() const {
        return !list.empty() || priority.rule != MaskPriority::Rule::LastByName;
    }
};

/// Finds the masks that the inputs are, in options.masks: those of --join, of --segments all, or
/// those of a folder. None: the input is one map.
/// \throws FileError, InvalidInput  as masksOfFolder(), masksOfFiles(), masksOfSegments(); the list
/// of --priority can't be read, or names what is no mask
void findMasks(LabelsOptions& options, LabelsRun& run);

/// Joins options.masks. Their fates go to run.joined, and warnings to run.warnings.
MaskMap joinMasks(LabelsRun& run);

}  // namespace adaptiso::labels
