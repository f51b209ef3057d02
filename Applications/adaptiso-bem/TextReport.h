#pragma once

#include <iosfwd>

#include "BemRun.h"

namespace adaptiso {

/// What a person at a terminal wants to know: surfaces, gaps, what was guessed, what was written.
void printReport(std::ostream& out, const BemRun& run);

/// Where and why there is no model, in one line; the point is in scanner RAS, as viewers show it.
std::string failureText(const BemRun& run);

}  // namespace adaptiso
