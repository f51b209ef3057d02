#pragma once

#include "Common/CliNames.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso::simplifier {

/// Name, description and closing help text of adaptiso-simplify.
Program simplifyProgram();

/// Adds adaptiso-simplify's options to `app`. Parsing throws a CLI::ParseError or a UsageError for
/// values, and for combinations of options, that make no sense.
void declareSimplifyOptions(CLI::App& app, SimplifyCommand& command);

}  // namespace adaptiso::simplifier
