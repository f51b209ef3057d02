#pragma once

#include <vector>

#include "Dataset.h"
#include "Pipeline.h"
#include "QualityTable.h"

namespace adaptiso {

/// Compares what exists of `chosen` with what was asked for, by the options of the participant
/// level if none are given, and writes the files of the whole dataset: quality.tsv and
/// quality.json, summary.html, dataset_description.json, README and .bidsignore. \return kExitOk,
/// or kExitCheckFailed: something is missing, failed or unsound; stderr names it \throws
/// InvalidInput  no participant has been run; or a table exists that was made with options
///                       which are neither these nor the participant level's
int runGroup(BidsOptions options, const ChosenSubjects& chosen);

}  // namespace adaptiso
