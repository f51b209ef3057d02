#pragma once

#include <string>

#include "BemRun.h"

namespace adaptiso {

/// The README.md of a model's folder: what is in it, in which frame and unit, and the lines of MNE
/// and OpenMEEG that use it. Names no input.
std::string modelReadme(const BemRun& run);

}  // namespace adaptiso
