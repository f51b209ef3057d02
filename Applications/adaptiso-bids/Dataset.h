#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "Common/Bids.h"
#include "Pipeline.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// The participants asked for, by name, without those that .bidsignore excludes.
struct ChosenSubjects {
    std::vector<std::filesystem::path> folders;
    /// "sub-02" and why its name, or one of its sessions or images, is not valid in BIDS.
    std::vector<std::pair<std::string, std::string>> faulty;
    std::vector<Warning> warnings;  ///< where participants.tsv differs
};

/// \throws InvalidInput  no BIDS dataset, no such participant, no participant; or an invalid
///                       description, unless validation is skipped
ChosenSubjects chooseSubjects(const BidsOptions& options);

/// "01" for the entity "sub" of "sub-01_ses-2_acq-hi"; may be empty.
std::string entityOf(const std::string& name, const std::string& key);

}  // namespace adaptiso
