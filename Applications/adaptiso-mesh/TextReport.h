#pragma once

#include <iosfwd>

#include "MeshRun.h"

namespace adaptiso {

/// What a person at a terminal wants to know: which files were written, what is in them, how long
/// it took.
void printReport(std::ostream& out, const MeshRun& run);

}  // namespace adaptiso
