#pragma once

#include <string>

#include "LabelsRun.h"

namespace adaptiso {

/// The report of --json, as README.md describes it.
std::string jsonReport(const LabelsRun& run);

/// The report for the output folder: the same without what differs from run to run (seconds,
/// memory, threads, the folder's name), so that the same input and options give the same bytes.
std::string folderReport(const LabelsRun& run);

}  // namespace adaptiso
