#pragma once

#include "Dataset.h"
#include "Pipeline.h"

namespace adaptiso {

/// Makes what is asked for of each of `chosen` that is not there yet, and tells of each scan in a
/// line. A participant that is faulty, and a scan that fails, costs itself alone. Writes below
/// their own folders of OUT_DIR only. \return as runBids()
int runParticipants(const BidsOptions& options, const ChosenSubjects& chosen);

/// Looks at what was made of `chosen`, by the options of the participant level where none are
/// given, and writes what is of the whole dataset: quality.tsv and quality.json, summary.html,
/// dataset_description.json, README and .bidsignore. \return kExitOk, or kExitCheckFailed:
/// something is missing, failed or unsound; stderr names it \throws InvalidInput  no participant
/// has been run; or a table is there that was made with options
///                       which are neither these nor the participant level's
int runGroup(BidsOptions options, const ChosenSubjects& chosen);

}  // namespace adaptiso
