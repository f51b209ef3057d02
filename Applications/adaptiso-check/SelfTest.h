#pragma once

#include "Pipeline.h"

namespace adaptiso {

/// Runs phantoms with known answers through the whole chain and prints, for each quantity, what was
/// expected, measured and allowed, with machine, version, date and a line to sign. --json and
/// --report hold the same.
/// \return kExitOk, or kExitCheckFailed when an answer is wrong
/// \throws FileError  nothing can be written
int runSelfTest(const CheckOptions& options);

}  // namespace adaptiso
