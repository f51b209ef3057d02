#pragma once

#include <iosfwd>

#include "BemRun.h"

namespace adaptiso {

/// What a person at a terminal wants to know: surfaces, gaps, what was guessed, what was written.
void printReport(std::ostream& out, const BemRun& run);

}  // namespace adaptiso
