#pragma once

#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso {

Program giantProgram();
void declareGiantOptions(CLI::App& app, GiantOptions& options);

}  // namespace adaptiso
