#pragma once

#include <iosfwd>

#include "CompareRun.h"

namespace adaptiso::compare {

/// What a person at a terminal wants to know: how far the surfaces lie apart, and where.
void printReport(std::ostream& out, const CompareRun& run);

}  // namespace adaptiso::compare
