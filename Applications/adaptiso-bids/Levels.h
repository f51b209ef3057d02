#pragma once

#include <filesystem>
#include <vector>

#include "Pipeline.h"

namespace adaptiso {

/// Makes what is asked for of each of `subjects` that is not there yet, and tells of each scan in a
/// line. Writes below their own folders of OUT_DIR only. \return as runBids()
int runParticipants(const BidsOptions& options, const std::vector<std::filesystem::path>& subjects);

/// Looks at what was made of `subjects`, and writes what is of the whole dataset: quality.tsv and
/// quality.json, summary.html, dataset_description.json, README and .bidsignore.
/// \return kExitOk, or kExitCheckFailed: something is missing, failed or unsound; stderr names it
/// \throws InvalidInput  no participant has been run
int runGroup(const BidsOptions& options, const std::vector<std::filesystem::path>& subjects);

}  // namespace adaptiso
