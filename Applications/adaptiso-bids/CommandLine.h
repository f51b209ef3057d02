#pragma once

#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso {

/// Name, description and closing help text of adaptiso-bids.
Program bidsProgram();

/// Adds adaptiso-bids's options to `app`. Parsing throws a CLI::ParseError or a UsageError.
void declareBidsOptions(CLI::App& app, BidsOptions& options);

}  // namespace adaptiso
