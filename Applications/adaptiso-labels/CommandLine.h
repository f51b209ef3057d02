#pragma once

#include "Common/CliNames.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso {

Program labelsProgram();

/// Adds all options of adaptiso-labels to `app`, bound to `options`. What can be told wrong from
/// the command line alone is refused there: UsageError.
void declareLabelsOptions(CLI::App& app, LabelsOptions& options);

}  // namespace adaptiso
