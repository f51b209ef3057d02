#pragma once

#include <ostream>

#include "LabelsRun.h"

namespace adaptiso {

/// What a run prints.
void printReport(std::ostream& out, const LabelsRun& run);

}  // namespace adaptiso
