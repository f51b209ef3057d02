#pragma once

#include "Pipeline.h"

namespace adaptiso::simplifier {

/// Runs adaptiso-simplify for each of many surfaces. \return, \throws as runBatch()
int runSimplifyBatch(const SimplifyCommand& command);

}  // namespace adaptiso::simplifier
