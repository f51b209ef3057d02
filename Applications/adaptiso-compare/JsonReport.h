#pragma once

#include <string>

#include "CompareRun.h"

namespace adaptiso::compare {

/// The report that --json asks for, as README.md describes it: schema "adaptiso-compare/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const CompareRun& run);

}  // namespace adaptiso::compare
