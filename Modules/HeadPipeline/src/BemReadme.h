#pragma once

#include <string>

#include "adaptiso/HeadPipeline/BemFiles.h"

namespace adaptiso {

/// The README.md of a model's folder: what is in it, in which frame and unit, and the lines of MNE
/// and OpenMEEG that use it. Names no input. \param maker  "adaptiso-bem 0.2.0"
std::string bemReadme(const BemModel& model, const BemFileOptions& options,
                      const std::string& maker);

}  // namespace adaptiso
