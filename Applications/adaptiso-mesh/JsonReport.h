#pragma once

#include <string>

#include "MeshRun.h"

namespace adaptiso {

/// The report that --json asks for, as README.md describes it: schema "adaptiso-mesh/1". Holds
/// file names without folders. A number that is not known, or not finite, is null.
std::string jsonReport(const MeshRun& run);

}  // namespace adaptiso
