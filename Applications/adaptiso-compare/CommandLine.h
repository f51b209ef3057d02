#pragma once

#include "Common/CliNames.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso::compare {

/// Name, description and closing help text of adaptiso-compare.
Program compareProgram();

/// Adds adaptiso-compare's options to `app`. Parsing throws a CLI::ParseError or a UsageError for
/// values, and for combinations of options, that make no sense.
void declareCompareOptions(CLI::App& app, CompareOptions& options);

}  // namespace adaptiso::compare
