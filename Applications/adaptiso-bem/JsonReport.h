#pragma once

#include <string>

#include "BemRun.h"

namespace adaptiso {

/// The report, as README.md describes it: schema "adaptiso-bem/1". Holds file names without
/// folders. A number that is not known, or not finite, is null.
std::string jsonReport(const BemRun& run);

}  // namespace adaptiso
