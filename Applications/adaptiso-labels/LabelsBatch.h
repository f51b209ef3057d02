#pragma once

#include "Pipeline.h"

namespace adaptiso {

/// Each input as a run of its own. \return an exit code
int runLabelsBatch(const LabelsOptions& options);

}  // namespace adaptiso
