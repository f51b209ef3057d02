#pragma once

#include <string>

#include "CheckRun.h"

namespace adaptiso {

/// The report that --json asks for, as README.md describes it: schema "adaptiso-check/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const CheckRun& run);

}  // namespace adaptiso
