#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// Page of a head model, or of why there is none. The caller adds the volume, the times, and who
/// made it when.
/// \param files  names and bytes of what was written; may be empty
Report bemReport(const BemModel& model,
                 const std::vector<std::pair<std::string, std::uintmax_t>>& files);

}  // namespace adaptiso
