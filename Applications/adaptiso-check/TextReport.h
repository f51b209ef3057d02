#pragma once

#include <iosfwd>

#include "CheckRun.h"

namespace adaptiso {

/// What a person at a terminal wants to know: what holds, what does not and where,
/// and whether that is what was required.
void printReport(std::ostream& out, const CheckRun& run);

}  // namespace adaptiso
