#pragma once

#include "Pipeline.h"

namespace adaptiso {

/// Runs adaptiso-check for each of many surfaces, or of many heads. \return, \throws as runBatch()
int runCheckBatch(const CheckOptions& options);

}  // namespace adaptiso
