#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/Bids.h"
#include "Pipeline.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// The participants asked for, by name, without those that .bidsignore leaves out.
struct ChosenSubjects {
    std::vector<std::filesystem::path> folders;
    /// Those whose names, or whose sessions' or images' names, are not BIDS's: "sub-02", and why.
    std::vector<std::pair<std::string, std::string>> faulty;
    std::vector<Warning> warnings;  ///< where participants.tsv lists others
};

/// \throws InvalidInput  no BIDS dataset, no such participant, none at all; or its description is
///                       not BIDS's, unless that is not to be looked at
ChosenSubjects chooseSubjects(const BidsOptions& options);

/// "01" of "sub-01_ses-2_acq-hi", for "sub"; empty: it has no such entity.
std::string entityOf(const std::string& name, const std::string& key);

}  // namespace adaptiso
