#pragma once

#include <string>

#include "SimplifyRun.h"

namespace adaptiso::simplifier {

/// The report of --json, as README.md describes it, with a line break at the end.
std::string jsonReport(const SimplifyRun& run);

}  // namespace adaptiso::simplifier
