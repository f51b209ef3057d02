#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/Bids.h"
#include "Pipeline.h"

namespace adaptiso {

/// The folders of the participants asked for, by name.
/// \throws InvalidInput  no BIDS dataset, no such participant, none at all; or the names are not
///                       those of a BIDS dataset, unless that is not to be looked at
std::vector<std::filesystem::path> chosenSubjects(const BidsOptions& options);

/// What in the dataset's description and in the names of participants, sessions and images is not
/// as BIDS has it, a line each.
std::vector<std::string> bidsFaults(const std::filesystem::path& root,
                                    const std::vector<std::filesystem::path>& subjects);

/// "01" of "sub-01_ses-2_acq-hi", for "sub"; empty: it has no such entity.
std::string entityOf(const std::string& name, const std::string& key);

}  // namespace adaptiso
