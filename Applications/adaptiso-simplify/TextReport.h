#pragma once

#include <iosfwd>

#include "SimplifyRun.h"

namespace adaptiso::simplifier {

/// What the program prints when nothing else is asked for.
void printReport(std::ostream& out, const SimplifyRun& run);

}  // namespace adaptiso::simplifier
